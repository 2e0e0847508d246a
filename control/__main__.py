"""python3 -m control reach | hold | grasp | campaign."""

from __future__ import annotations

from rom.interruption import interruptible

if __name__ == "__main__":
    interruptible()  # what comes next takes a second to import

import math
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from control import Finger, Gripper, Object, SimulatedPlant
from control.model import Model
from rom import Chain, Surrogate, TouchedSegment
from rom.checked_file import kind_of
from rom.command_line import NOTHING_USABLE, AsJson, application, run, show
from rom.segment import chain
from rom.segment.objects import facing_plane
from rom.terminal import steps

app = application()
ModelFile = Annotated[Path, typer.Argument(metavar="MODEL.h5")]
OptionalModelFile = Annotated[
    Path | None,
    typer.Argument(metavar="MODEL.h5", show_default=False, help="The finger that comes with fingerfem if left out."),
]
ContactForce = Annotated[float, typer.Option(help="To hold [N], above 0.")]


def model_of(file: Path | None) -> Model:
    """The model of a file, or the one that comes along; segments' maps stand before the plane y = side/2 + d."""
    if file is None or kind_of(file) not in chain.KINDS:
        return Surrogate.load(file)
    segments = Chain.load(file)
    geometry = segments.scene["geometry"]
    return TouchedSegment(segment=segments, obstacle=facing_plane(geometry["side"], (0.0, sum(geometry["segments"]))))


@app.command(context_settings={"ignore_unknown_options": True})
def reach(
    model: ModelFile,
    point: Annotated[tuple[float, float, float], typer.Argument(help="x y z [m]")],
    distance: Annotated[float, typer.Option(help="Of the plane not to touch [m].")] = math.inf,
    as_json: AsJson = False,
) -> None:
    """Tensions that bring the tip plate's centre to a point before contact."""
    motion = Finger(model_of(model)).reach(point, distance)
    show(motion.as_json(), as_json, 0 if motion.converged else NOTHING_USABLE)


@app.command()
def hold(
    distance: Annotated[float, typer.Option(help="Of the plane [m].")],
    model: OptionalModelFile = None,
    contact_force: Annotated[float | None, typer.Option(help="To hold [N], above 0; 1 N if left out.")] = None,
    pad_pressure: Annotated[float | None, typer.Option(help="To hold instead [Pa], above 0.")] = None,
    as_json: AsJson = False,
) -> None:
    """Tensions that press on the plane with a contact force, or with a pressure on the pad."""
    known = model_of(model)
    lower, upper = (limits[-1] for limits in known.limits)
    if known.has_obstacle and not lower <= distance <= upper:
        raise ValueError(f"distance must lie in [{lower:g}, {upper:g}] m, got {distance:g}")
    if contact_force is None and pad_pressure is None:
        contact_force = 1.0
    for name, value, unit in (("contact_force", contact_force, "N"), ("pad_pressure", pad_pressure, "Pa")):
        if value is not None and not 0 < value < math.inf:
            raise ValueError(f"{name} must be above 0 {unit}, got {value:g}")
    motion = Finger(known).hold(contact_force, distance, pad_pressure=pad_pressure)
    show(motion.as_json(), as_json, 0 if motion.converged else NOTHING_USABLE)


@app.command()
def grasp(
    model: OptionalModelFile = None,
    centre: Annotated[tuple[float, float], typer.Option(help="Of the object, unknown to the controller [m].")] = (
        0.002,
        -0.001,
    ),
    radius: Annotated[float, typer.Option(help="Of the object [m].")] = 0.012,
    contact_force: ContactForce = 1.0,
    held: Annotated[
        tuple[float, float, float] | None,
        typer.Option(
            "--object", help="Mass [kg], friction [-], admissible force [N]: forces that neither drop nor crush."
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Three simulated fingers close around an object of unknown position and hold it."""
    known = model_of(model)
    gripper = Gripper(known)
    plants = [SimulatedPlant(known, distance) for distance in gripper.distances(centre, radius)]
    forces: float | np.ndarray = contact_force
    if held is not None:
        mass, friction, admissible = held
        targets = gripper.targets(Object(mass=mass, friction=friction, admissible_force=admissible))
        if not targets.exist:
            show({"status": "no targets", "reason": targets.reason}, as_json, NOTHING_USABLE)
            return
        forces = targets.contact_forces
    result = gripper.grasp(forces, plants)
    show(result.as_json(), as_json, 0 if result.converged else NOTHING_USABLE)


@app.command()
def campaign(
    model: OptionalModelFile = None,
    starts: Annotated[int, typer.Option(min=4, help="How many.")] = 10000,
    contact_force: ContactForce = 1.0,
    sweep: Annotated[bool, typer.Option("--sweep", help="A square grid of distances and lead tensions.")] = False,
    as_json: AsJson = False,
) -> None:
    """Hold one force at random distances from random starts; count what came of it and how long it took."""
    from control.campaign import run as hold_all

    with steps() as progress:
        result = hold_all(model_of(model), starts, contact_force, sweep, progress=progress).as_json()
    show(result, as_json, 0 if result["converged"] else NOTHING_USABLE)


if __name__ == "__main__":
    run(app)
