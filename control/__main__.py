"""python3 -m control reach | hold | grasp | campaign."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from control import Finger, Gripper, SimulatedPlant
from rom import Surrogate
from rom.commands import NOTHING_USABLE, AsJson, application, run, show

app = application()
ModelFile = Annotated[Path, typer.Argument(metavar="MODEL.h5")]
ContactForce = Annotated[float, typer.Option(help="To hold [N], above 0.")]


@app.command(context_settings={"ignore_unknown_options": True})
def reach(
    model: ModelFile,
    point: Annotated[tuple[float, float, float], typer.Argument(help="x y z [m]")],
    distance: Annotated[float, typer.Option(help="Of the plane not to touch [m].")] = math.inf,
    as_json: AsJson = False,
) -> None:
    """Tensions that bring the tip plate's centre to a point before contact."""
    motion = Finger(Surrogate.load(model)).reach(point, distance)
    show(motion.as_json(), as_json, 0 if motion.converged else NOTHING_USABLE)


@app.command()
def hold(
    model: ModelFile,
    distance: Annotated[float, typer.Option(help="Of the plane [m].")],
    contact_force: ContactForce = 1.0,
    as_json: AsJson = False,
) -> None:
    """Tensions that press on the plane with a contact force."""
    surrogate = Surrogate.load(model)
    lower, upper = (limits[-1] for limits in surrogate.limits)
    if surrogate.has_obstacle and not lower <= distance <= upper:
        raise ValueError(f"distance must lie in [{lower:g}, {upper:g}] m, got {distance:g}")
    if not contact_force > 0:
        raise ValueError(f"contact_force must be above 0 N, got {contact_force:g}")
    motion = Finger(surrogate).hold(contact_force, distance)
    show(motion.as_json(), as_json, 0 if motion.converged else NOTHING_USABLE)


@app.command()
def grasp(
    model: ModelFile,
    centre: Annotated[tuple[float, float], typer.Option(help="Of the object, unknown to the controller [m].")] = (
        0.002,
        -0.001,
    ),
    radius: Annotated[float, typer.Option(help="Of the object [m].")] = 0.012,
    contact_force: ContactForce = 1.0,
    as_json: AsJson = False,
) -> None:
    """Three simulated fingers close around an object of unknown position and hold it."""
    surrogate = Surrogate.load(model)
    gripper = Gripper(surrogate)
    plants = [SimulatedPlant(surrogate, distance) for distance in gripper.distances(centre, radius)]
    result = gripper.grasp(contact_force, plants)
    show(result.as_json(), as_json, 0 if result.converged else NOTHING_USABLE)


@app.command()
def campaign(
    model: ModelFile,
    starts: Annotated[int, typer.Option(min=4, help="How many: a square, as many distances as lead tensions.")] = 10000,
    contact_force: ContactForce = 1.0,
    as_json: AsJson = False,
) -> None:
    """Hold one force at many distances from many starts; count what came of it and how long it took."""
    from control import campaign as authors_sweep

    result = authors_sweep.run(Surrogate.load(model), starts, contact_force)
    show(result, as_json, 0 if result["converged"] else NOTHING_USABLE)


if __name__ == "__main__":
    run(app)
