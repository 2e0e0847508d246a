"""python3 -m control reach | hold | grasp | campaign | calibrate | export."""

from rom.console.program import begin

if __name__ == "__main__":
    begin()

import math
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from control import Finger, Gripper, Object, SimulatedPlant
from control.calibration.command import calibrate
from control.grasping.gripper import Grasp
from control.model import Model
from control.motion import Motion
from rom import load
from rom.console.command_line import NOTHING_USABLE, AsJson, application, run
from rom.console.table import Table, millimetres, percent, show
from rom.console.terminal import say, steps
from rom.files.atomic_file import check_folder

app = application()
COUNTED = ("converged", "unreachable", "failed", "out_of_limits")
ModelFile = Annotated[Path, typer.Argument(metavar="MODEL.h5")]
OptionalModelFile = Annotated[
    Path | None,
    typer.Argument(metavar="MODEL.h5", show_default=False, help="The bundled finger by default."),
]
ContactForce = Annotated[float, typer.Option(help="To hold [N], above 0.")]


@app.command(context_settings={"ignore_unknown_options": True})
def reach(
    model: ModelFile,
    point: Annotated[tuple[float, float, float], typer.Argument(help="x y z [m]")],
    distance: Annotated[float, typer.Option(help="Of the plane not to touch [m].")] = math.inf,
    as_json: AsJson = False,
) -> None:
    """Tensions that bring the tip plate's centre to a point before contact."""
    if not np.isfinite(point).all() or math.isnan(distance):
        raise ValueError(f"point and distance must be numbers, got {point}, {distance:g}")
    finger = load(model)
    show_motion(finger, Finger(finger).reach(point, distance), as_json)


@app.command()
def hold(
    distance: Annotated[float, typer.Option(help="Of the plane [m].")],
    model: OptionalModelFile = None,
    contact_force: Annotated[float | None, typer.Option(help="To hold [N], above 0; 1 N by default.")] = None,
    pad_pressure: Annotated[float | None, typer.Option(help="To hold instead [Pa], above 0.")] = None,
    as_json: AsJson = False,
) -> None:
    """Tensions that press on the plane with a contact force, or with a pressure on the pad."""
    finger = load(model)
    lower, upper = (limits[-1] for limits in finger.limits)
    if finger.has_obstacle and not lower <= distance <= upper:
        raise ValueError(f"distance must lie in [{lower:g}, {upper:g}] m, got {distance:g}")
    if contact_force is None and pad_pressure is None:
        contact_force = 1.0
    for name, value, unit in (("contact_force", contact_force, "N"), ("pad_pressure", pad_pressure, "Pa")):
        if value is not None and not 0 < value < math.inf:
            raise ValueError(f"{name} must be above 0 {unit}, got {value:g}")
    show_motion(finger, Finger(finger).hold(contact_force, distance, pad_pressure=pad_pressure), as_json)


def show_motion(model: Model, motion: Motion, as_json: bool) -> None:
    """Tensions, and the model's answer there; the tip on the side that is pulled."""
    names = [one.name for one in model.parameters[: len(motion.tensions)]]
    at = motion.tensions if not model.has_obstacle else np.append(motion.tensions, motion.distance)
    answer = model.evaluate(at).mirrored(motion.sides)
    numbers = motion.as_json() | {"answer": answer.as_json(names)}
    show(numbers, motion.tables(names, answer), as_json, 0 if motion.converged else NOTHING_USABLE)


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
    if not 0 < radius < math.inf:
        raise ValueError(f"radius must be above 0 m, got {radius:g}")
    finger = load(model)
    gripper = Gripper(finger)
    plants = [SimulatedPlant(finger, distance) for distance in gripper.distances(centre, radius)]
    forces: float | np.ndarray = contact_force
    if held is not None:
        mass, friction, admissible = held
        targets = gripper.targets(Object(mass=mass, friction=friction, admissible_force=admissible))
        if not targets.exist:
            lines = [f"no forces hold it: {targets.reason}"]
            show({"status": "no targets", "reason": targets.reason}, lines, as_json, NOTHING_USABLE)
        forces = targets.contact_forces
    result = gripper.grasp(forces, plants)
    show(result.as_json(), grasp_parts(finger, result), as_json, 0 if result.converged else NOTHING_USABLE)


def grasp_parts(model: Model, result: Grasp) -> list[Table | str]:
    """A grasp for people, a row per finger."""
    names = [one.name for one in model.parameters[: result.tensions.shape[1]]]
    header, rows = ["finger", *(f"{name} [N]" for name in names), "force [N]", "d [mm]", "status"], []
    for k, tensions in enumerate(result.tensions):
        numbers = [*(f"{value:.3f}" for value in tensions), f"{result.contact_forces[k]:.4f}"]
        rows.append([str(k + 1), *numbers, f"{1e3 * result.distances[k]:.3f}", result.status[k]])
    if not np.isfinite(result.radius):
        return [Table(header=header, rows=rows), f"object not found, by {len(result.history)} pulls"]
    place = f"object found at {millimetres(result.centre)}, radius {1e3 * result.radius:.3f} mm"
    return [Table(header=header, rows=rows), f"{place}, by {len(result.history)} pulls"]


@app.command()
def campaign(
    model: OptionalModelFile = None,
    starts: Annotated[int, typer.Option(min=4, help="How many.")] = 10000,
    contact_force: ContactForce = 1.0,
    sweep: Annotated[bool, typer.Option("--sweep", help="A square grid of distances and lead tensions.")] = False,
    as_json: AsJson = False,
) -> None:
    """Hold one force at random distances from random starts; count the results and measure their times."""
    from control.campaign import run as hold_all

    with steps() as progress:
        result = hold_all(load(model), starts, contact_force, sweep, progress=progress).as_json()
    counts = [[name.replace("_", " "), str(result[name]), percent(result[name] / result["starts"])] for name in COUNTED]
    times = [
        [what, *(f"{result[prefix + key]:.3g}" for key in ("mean_us", "p50_us", "p99_us", "max_us"))]
        for what, prefix in (("compiled", ""), ("called from Python", "call_"))
    ]
    parts = [
        Table(
            title=f"{result['starts']} holds of {contact_force:g} N", header=["outcome", "holds", "share"], rows=counts
        ),
        Table(header=["time per hold [µs]", "mean", "median", "99 % below", "longest"], rows=times),
    ]
    show(result, parts, as_json, 0 if result["converged"] else NOTHING_USABLE)


app.command()(calibrate)


@app.command("export")
def export_controller(
    model: ModelFile,
    output: Annotated[Path, typer.Argument(metavar="FINGER.html|FINGER.fmu", help="A page or an FMU, by its ending.")],
    tolerance: Annotated[
        float, typer.Option(min=0, max=0.5, help="Of a table: keep only the terms this relative error needs.")
    ] = 0.0,
    fmi: Annotated[int, typer.Option(metavar="2|3", help="Version of FMI of an FMU.")] = 3,
) -> None:
    """Write a controller for those without Python: a page for a browser, or an FMU that holds a contact force.

    On the page the finger bends as sliders move; it is one file and needs no network. The FMU is for co-simulation.
    """
    check_folder(output)
    finger, ending = load(model, tolerance), output.suffix.lower()
    if ending == ".fmu":
        from control.export.fmu import write as write_fmu

        write_fmu(finger, output, fmi)
        kind = f"FMI {fmi}.0 for co-simulation"
    elif ending in (".html", ".htm") and fmi == 3:
        from control.export.page import write as write_page

        write_page(finger, output)
        kind = "open it in a browser"
    else:
        ask = "--fmi needs .fmu" if ending in (".html", ".htm") else "rom export writes .h and the FMU of a model"
        raise ValueError(f"output must be named .html or .fmu, got {output}; {ask}")
    say(f"{output}: {output.stat().st_size / 1e6:.1f} MB; {kind}")


if __name__ == "__main__":
    run(app)
