"""python3 -m rom build | assemble | specialise | check | info | export."""

from rom.console.program import begin

if __name__ == "__main__":
    begin()

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from rom import load
from rom.console.command_line import NOTHING_USABLE, AsJson, application, check_parts, run
from rom.console.table import percent, show
from rom.console.terminal import log_lines, say, steps
from rom.dataset.snapshot_set import SnapshotSet
from rom.files.atomic_file import check_folder
from rom.files.checked_file import kind_of
from rom.files.file_kinds import uses_of
from rom.rod import rod
from rom.rod.rod import Rod
from rom.rod.touched_segment import TouchedSegment
from rom.separated.alternating_directions import EnrichmentOptions
from rom.separated.model import SeparatedModel
from rom.separated.rod_source import NODES
from rom.summaries import origin, rod_summary, separated_summary

MOST = 1.0  # expected relative error of a model that is written [-]
app = application()
ModelFile = Annotated[Path, typer.Argument(metavar="MODEL.h5")]
Tolerance = Annotated[
    float, typer.Option(min=0, max=0.5, help="Of a table: keep only the terms this relative error needs.")
]


@app.command()
def build(
    folder: Annotated[Path, typer.Argument(metavar="SET/", help="A complete training set.")],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="MODEL.h5")],
    held_out: Annotated[
        Path | None,
        typer.Option(metavar="HELDOUT/", help="Measure the error on these states."),
    ] = None,
    finer: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FINER/",
            help="Held-out states on a finer mesh: estimated errors then count the mesh's. Of a scene with a load, "
            "pressed ones correct the elements; may be given several times.",
        ),
    ] = None,
    terms: Annotated[
        int | None, typer.Option(min=1, max=10_000, help="Of a grid: most products of a form, 200.")
    ] = None,
    degree: Annotated[
        float | None,
        typer.Option(min=2, max=8, help="Of rod elements: highest degree that is tried, 5; 6 suits longer fingers."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Write a model with expected errors above 100 %.")] = False,
    as_json: AsJson = False,
) -> None:
    """Build a model: rod elements and their finger from pressed states, a separated model from states on a grid."""
    log_lines()
    check_folder(output)
    snapshots, finer_sets = SnapshotSet(folder), [SnapshotSet(one) for one in finer or []]
    states = None if held_out is None else held_out_of(held_out)
    if not snapshots.description.has_load:
        if degree is not None:
            raise ValueError(f"degree must be left out for a set of states on a grid, got {degree:g}")
        separate_set(snapshots, output, states, finer_sets, terms, force, as_json)
    if terms is not None:
        raise ValueError(f"terms must be left out for a set of a scene with a load, got {terms}")
    from rom.build import train_rod
    from rom.elements.fitting.degrees import HIGHEST

    with steps() as progress:
        finger = train_rod(snapshots, origin(snapshots), finer_sets, progress, degree or HIGHEST)
    finger = finger if states is None else finger.with_accuracy(check_rod(finger, states))
    check_expected(finger.errors.contact_force, output, force)
    finger.save(output)
    show(rod_summary(finger), finger.tables(), as_json)


def separate_set(
    snapshots: SnapshotSet,
    output: Path,
    held_out: SnapshotSet | None,
    finer: list[SnapshotSet],
    terms: int | None,
    force: bool,
    as_json: bool,
) -> None:
    """Separate states on a grid, write the model, and end."""
    from rom.build import separate_grid

    if len(finer) > 1:
        raise ValueError(f"finer must be one set for a scene without a load, got {len(finer)}")
    with steps() as progress:
        table = separate_grid(
            snapshots,
            enrichment(terms),
            held_out=held_out,
            finer=finer[0] if finer else None,
            progress=progress,
        )
    write_separated(table, output, force, as_json)


def write_separated(table: SeparatedModel, output: Path, force: bool, as_json: bool) -> None:
    """Write a separated model unless its contact force is off by more than itself, and end."""
    measured = table.accuracy.get("contact_force", {}).get("p95")
    if measured is not None:
        check_expected(measured, output, force)
    table.save(output)
    show(separated_summary(table), table.tables(), as_json)


def check_expected(error: float, output: Path, force: bool) -> None:
    """Refuse to write a model whose contact force is expected to be off by more than itself [-]."""
    if error > MOST and not force:
        expected = f"contact force is expected within {percent(error)} only (95 %), must be within {percent(MOST)}"
        say(f"{expected}: {output} was not written; solve more states, or write it by --force")
        raise SystemExit(NOTHING_USABLE)


def held_out_of(folder: Path) -> SnapshotSet:
    """A held-out set."""
    states = SnapshotSet(folder)
    if not states.description.random:
        raise ValueError(f"{folder}: must be a held-out set (made with --random){uses_of(folder)}")
    return states


def check_rod(finger: Rod, held_out: SnapshotSet) -> dict:
    """Errors of a finger in held-out states: pressed ones, or those before the plane, of any mesh."""
    if held_out.description.has_load:
        from rom.rod.pressed_check import check_pressed

        return check_pressed(finger, held_out)
    return check_before_plane(finger, held_out)


def check_before_plane(model: Rod | SeparatedModel, held_out: SnapshotSet) -> dict:
    """Errors of a model in states before the plane."""
    from rom.plane_check import check

    with steps() as progress:
        return check(model, held_out, progress)


@app.command()
def assemble(
    scene: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="The finger: geometry, material and tendons.")],
    trained: Annotated[Path, typer.Argument(metavar="ELEMENTS.h5", help="A finger, whose elements are taken.")],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FINGER.h5")],
    as_json: AsJson = False,
) -> None:
    """Assemble the finger of a scene from the elements of another: of any length, size, modulus, up to 8 segments."""
    check_folder(output)
    finger = Rod.load(trained).assembled(scene)
    finger.save(output)
    show(rod_summary(finger), finger.tables(), as_json)


@app.command()
def specialise(
    source: Annotated[Path, typer.Argument(metavar="FINGER.h5", help="A finger of rod elements.")],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="TABLE.h5")],
    distances: Annotated[
        tuple[float, float] | None,
        typer.Option(metavar="LOW HIGH", help="Range of d [m]; from a fiftieth to 0.62 of the length by default."),
    ] = None,
    nodes: Annotated[int, typer.Option(min=4, max=200, help="Nodes of every axis.")] = NODES,
    terms: Annotated[int, typer.Option(min=1, max=10_000, help="Most products of a form; fewer on few nodes.")] = 200,
    force: Annotated[bool, typer.Option("--force", help="Write a table with errors above 100 %.")] = False,
    as_json: AsJson = False,
) -> None:
    """Separate a finger's answers before the plane y = side/2 + d: a table that answers in a microsecond."""
    from rom.separated.rod_source import specialise as specialised

    check_folder(output)
    finger = before_plane(TouchedSegment.load(source), distances)
    with steps() as progress:
        table = specialised(finger, nodes, enrichment(terms), progress=progress)
    write_separated(table, output, force, as_json)


def enrichment(terms: int | None) -> EnrichmentOptions:
    """Options of the separation with at most so many products."""
    return EnrichmentOptions() if terms is None else EnrichmentOptions(terms=terms)


def before_plane(finger: TouchedSegment, distances: tuple[float, float] | None) -> TouchedSegment:
    """A finger before its plane at distances of a range [m], by default the paper's over its length."""
    length = finger.obstacle.distances[1]
    low, high = distances or (length / 50, 0.62 * length)
    if not 0 <= low < high <= length:
        raise ValueError(f"distances must be two from 0 to {length:g} m, the smaller one first, got {low:g} {high:g}")
    return replace(finger, obstacle=replace(finger.obstacle, distances=(low, high)))


@app.command("check")
def check_model(
    model: ModelFile,
    states: Annotated[Path, typer.Argument(metavar="SET/", help="Held-out or training states, of any mesh.")],
    tolerance: Tolerance = 0.0,
    as_json: AsJson = False,
) -> None:
    """Compare a model with full-order states: held-out ones, or those that it was trained on."""
    known, snapshots = load(model, tolerance), SnapshotSet(states)
    report = (
        check_rod(known.rod, snapshots) if isinstance(known, TouchedSegment) else check_before_plane(known, snapshots)
    )
    show(report, check_parts(report), as_json)


@app.command()
def info(model: ModelFile, as_json: AsJson = False) -> None:
    """Show a model file's parameters with units and ranges, its terms, accuracy and versions."""
    if kind_of(model) == rod.KIND:
        finger = Rod.load(model)
        show(rod_summary(finger), finger.tables(), as_json)
    known = SeparatedModel.load(model)
    show(separated_summary(known), known.tables(), as_json)


@app.command("export")
def export_model(
    model: ModelFile,
    output: Annotated[Path, typer.Argument(metavar="FINGER.h|FINGER.fmu", help="A C header or an FMU, by its ending.")],
    tolerance: Tolerance = 0.0,
    fmi: Annotated[int, typer.Option(metavar="2|3", help="Version of FMI of an FMU.")] = 3,
) -> None:
    """Write a model for those without Python: a C99 header, FINGER.h, or an FMU for co-simulation, FINGER.fmu.

    A header has values and gradients of a model, without allocation; its name begins every name in it.
    An FMU has C sources and a library for Linux in it.
    """
    check_folder(output)
    known = load(model, tolerance)
    if output.suffix.lower() != ".fmu":
        from rom.export.c_header import export

        if output.suffix.lower() != ".h":
            raise ValueError(f"output must be named .h or .fmu, got {output}; control export writes .html")
        if fmi != 3:
            raise ValueError(f"output must be named .fmu for --fmi, got {output}")
        export(known, output)
        say(f"{output}: {output.stat().st_size / 1e6:.1f} MB; its first lines describe it")
        return
    from rom.export.fmu import write

    write(known, output, fmi)
    say(f"{output}: FMI {fmi}.0 for co-simulation, {output.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    run(app)
