"""python3 -m control reach | hold | grasp | campaign."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Annotated

import typer

from control import Finger, Gripper, SimulatedPlant
from rom import Surrogate

app = typer.Typer(add_completion=False, no_args_is_help=True, rich_markup_mode=None, pretty_exceptions_enable=False)
BAD_INPUT, NOTHING_USABLE = 2, 3
ModelFile = Annotated[Path, typer.Argument(metavar="MODEL.h5")]
ContactForce = Annotated[float, typer.Option(help="[N]")]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object on stdout.")]


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
    motion = Finger(Surrogate.load(model)).hold(contact_force, distance)
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
    starts: Annotated[int, typer.Option(min=1, help="Distances times starting tensions.")] = 10000,
    contact_force: ContactForce = 1.0,
    as_json: AsJson = False,
) -> None:
    """Hold one force at many distances from many starts; count what came of it and how long it took."""
    from control.campaign import run

    show(run(Surrogate.load(model), starts, contact_force), as_json)


def show(result: dict, as_json: bool, code: int = 0) -> None:
    """Print as JSON (strict: nan and inf become null), or line by line."""
    if as_json:
        print(json.dumps(_strict(result)))
    else:
        for name, value in result.items():
            print(f"{name:16s} {value}")
    raise SystemExit(code)


def _strict(value):
    if isinstance(value, dict):
        return {key: _strict(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_strict(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def main() -> None:
    """Run the command; bad input is one line and exit code 2."""
    try:
        app()
    except ValueError as error:
        print(error, file=sys.stderr)
        raise SystemExit(BAD_INPUT) from None


if __name__ == "__main__":
    main()
