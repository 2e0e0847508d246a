"""python3 -m rom build | assemble | specialise | check | info | export | page."""

from __future__ import annotations

from rom.program import begin

if __name__ == "__main__":
    begin()

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from rom import load
from rom.checked_file import kind_of
from rom.command_line import NOTHING_USABLE, AsJson, application, check_parts, run, show
from rom.file_kinds import uses_of
from rom.rod import rod
from rom.rod.rod import Rod
from rom.rod.touched_segment import TouchedSegment
from rom.snapshots.description import difference
from rom.snapshots.snapshot_set import SnapshotSet
from rom.summaries import origin, rod_summary, summary
from rom.surrogate import Surrogate
from rom.table import percent
from rom.terminal import log_lines, say, steps

MOST = 1.0  # expected relative error of a model that is written [-]
app = application()
ModelFile = Annotated[Path, typer.Argument(metavar="MODEL.h5")]


@app.command()
def build(
    folder: Annotated[Path, typer.Argument(metavar="SET/", help="A complete training set.")],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="MODEL.h5")],
    tolerance: Annotated[
        float | None,
        typer.Option(
            min=1e-12, max=0.5, help="Relative error of the separation; 3e-4, or what the scene's accuracy chose."
        ),
    ] = None,
    terms: Annotated[
        int | None,
        typer.Option(min=1, max=10_000, help="Most products of one separated form, 100."),
    ] = None,
    held_out: Annotated[
        Path | None,
        typer.Option(metavar="HELDOUT/", help="Measure the error on these states."),
    ] = None,
    coarse: Annotated[
        Path | None, typer.Option(metavar="SET/", help="States of the same finger on a coarser mesh, to be corrected.")
    ] = None,
    finer: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FINER/",
            help="Held-out states on a finer mesh: estimated errors then count the mesh's. Of a scene with a load, "
            "pressed ones correct the elements; may be given several times.",
        ),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Write a model that expects errors above 100 %, or lacks its coarse set.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Separate a snapshot set and write the model file; of a scene with a load, train rod elements and its finger."""
    log_lines()
    check_folder(output)
    snapshots = SnapshotSet(folder)
    if snapshots.description.has_load:
        for name, value in (("tolerance", tolerance), ("terms", terms), ("coarse", coarse)):
            if value is not None:
                raise ValueError(f"{name} must be left out for a set of a scene with a load, got {value}")
        from rom.build import train_rod

        states, finer_sets = (None if held_out is None else SnapshotSet(held_out)), map(SnapshotSet, finer or [])
        with steps() as progress:
            finger = train_rod(snapshots, origin(snapshots), list(finer_sets), progress)
        finger = finger if states is None else finger.with_accuracy(check_rod(finger, states))
        check_expected(finger.errors.contact_force, output, force)
        finger.save(output)
        show(rod_summary(finger), finger.tables(), as_json)
    if not force and coarse is None and snapshots.description.scene.get("coarse"):
        raise ValueError(
            f"coarse must be given, as the scene of {folder} names a coarse mesh, got none: solve its states by "
            "fingerfem snapshots --coarse, then rom build --coarse SET/; --force builds without them"
        )
    from rom.build import train
    from rom.error_model import calibrated, covering_training, expected_error, with_mesh_error
    from rom.held_out import accuracy, check, check_against, check_finer
    from rom.separated.alternating_directions import EnrichmentOptions

    if tolerance is None:
        expected = snapshots.description.scene.get("expected") or {}
        tolerance = expected.get("tolerance", EnrichmentOptions().tolerance)
    options = EnrichmentOptions(tolerance=tolerance, **({} if terms is None else {"terms": terms}))
    states = None if held_out is None else held_out_of(snapshots, held_out)
    if finer and len(finer) > 1:
        raise ValueError(f"finer must be one set for a scene without a load, got {len(finer)}")
    finer_states = SnapshotSet(finer[0]) if finer else None
    if finer_states is not None:
        check_finer(snapshots.description.scene, finer_states)
    with steps() as progress:
        model = train(snapshots, options, None if coarse is None else SnapshotSet(coarse), progress=progress)
        if states is not None:
            model = calibrated(model, states)
        model = covering_training(model, snapshots)
        if states is not None:
            model = replace(model, accuracy=accuracy(check(model, states, progress)))
        if finer_states is not None:
            model = with_mesh_error(model, finer_states)
            total = accuracy(check_against(model, finer_states, progress))
            model = replace(model, accuracy=model.accuracy | {"against_finer_mesh": total})
    measured = model.accuracy.get("contact_force", {}).get("p95")
    check_expected(expected_error(model, snapshots) if measured is None else measured, output, force)
    model.save(output)
    show(summary(model), model.tables(), as_json)


def check_folder(output: Path) -> None:
    """Refuse a file that could not be written, before there is anything to write."""
    if not output.parent.is_dir():
        raise ValueError(f"output must be in a folder that exists, got {output}")


def check_expected(error: float, output: Path, force: bool) -> None:
    """Refuse to write a model whose contact force is expected to be off by more than itself [-]."""
    if error > MOST and not force:
        told = f"contact force is expected within {percent(error)} only (95 %), must be within {percent(MOST)}"
        say(f"{told}: {output} was not written; solve more states, or write it by --force")
        raise SystemExit(NOTHING_USABLE)


def held_out_of(training: SnapshotSet, folder: Path) -> SnapshotSet:
    """A training set's held-out set, looked at before there is a model to measure."""
    found = SnapshotSet(folder)
    if not found.description.random:
        raise ValueError(f"{folder}: must be a held-out set (made with --random){uses_of(folder)}")
    if found.description.fingerprint != training.description.fingerprint:
        other = difference(training.description.scene, found.description.scene)
        raise ValueError(f"{folder}: must hold states of the training set's scene: {other}")
    return found


def check_rod(finger: Rod, held_out: SnapshotSet) -> dict:
    """Errors of a finger in held-out states: pressed ones, or those before the plane, of any mesh."""
    if held_out.description.has_load:
        from rom.rod.check import check_pressed

        return check_pressed(finger, held_out)
    from rom.held_out import check_plane

    with steps() as progress:
        return check_plane(finger, held_out, progress)


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
    source: Annotated[
        Path, typer.Argument(metavar="FINGER.h5|SET/", help="A finger of elements, or a training set on a grid.")
    ],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="TABLE.h5")],
    distances: Annotated[
        tuple[float, float] | None,
        typer.Option(
            metavar="LOW HIGH", help="Range of d [m] of a finger; from a fiftieth to 0.62 of its length by default."
        ),
    ] = None,
    held_out: Annotated[
        Path | None, typer.Option(metavar="HELDOUT/", help="Measure the error of a set's table on these states.")
    ] = None,
    nodes: Annotated[int, typer.Option(min=4, max=200, help="Nodes of every axis.")] = 32,
    terms: Annotated[int, typer.Option(min=1, max=10_000, help="Most products of a form; fewer on few nodes.")] = 200,
    force: Annotated[bool, typer.Option("--force", help="Write a table with errors above 100 %.")] = False,
    as_json: AsJson = False,
) -> None:
    """Separate answers before the plane y = side/2 + d, as the paper does: a table that answers in a microsecond."""
    from rom.separated.alternating_directions import EnrichmentOptions
    from rom.specialised.grid_source import separate_grid
    from rom.specialised.rod_source import specialise as specialised
    from rom.specialised.table import TOLERANCE

    check_folder(output)
    options = EnrichmentOptions(tolerance=TOLERANCE, terms=terms)
    if source.is_dir():
        if distances is not None:
            raise ValueError("distances must be left out for a set, whose scene has a range of d")
        snapshots = SnapshotSet(source)
        states = None if held_out is None else held_out_of(snapshots, held_out)
        with steps() as progress:
            table = separate_grid(snapshots, nodes, options, held_out=states, progress=progress)
    else:
        if held_out is not None:
            raise ValueError("held-out must be left out for a finger of elements, which a table is compared with")
        finger = before_plane(TouchedSegment.load(source), distances)
        with steps() as progress:
            table = specialised(finger, nodes, options, progress=progress)
    measured = table.accuracy.get("contact_force", {}).get("p95")
    if measured is not None:
        check_expected(measured, output, force)
    table.save(output)
    show(summary(table), table.tables(), as_json)


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
    held_out: Annotated[
        Path | None, typer.Argument(metavar="SET/", help="Made with --random; or the training set itself.")
    ] = None,
    against: Annotated[
        Path | None, typer.Option(metavar="FINER/", help="One on a finer mesh: mesh and surrogate err together.")
    ] = None,
    tolerance: Annotated[
        float, typer.Option(min=0, max=0.5, help="Keep only the terms this relative error needs.")
    ] = 0.0,
    as_json: AsJson = False,
) -> None:
    """Compare a model with full-order states: held-out ones, or those that it was trained on."""
    if held_out is None and against is None:
        raise ValueError("SET/ or --against FINER/ must be given, got neither")
    if kind_of(model) == rod.KIND:
        if held_out is None or against is not None:
            raise ValueError("against must be left out for a finger of elements: SET/ may be of any mesh")
        found = check_rod(Rod.load(model), SnapshotSet(held_out))
        show(found, check_parts(found), as_json)
    from rom.held_out import check, check_against

    surrogate = Surrogate.load(model, tolerance=tolerance)
    with steps() as progress:
        report = check(surrogate, SnapshotSet(held_out), progress) if held_out is not None else {}
        if against is not None:
            report["against"] = check_against(surrogate, SnapshotSet(against), progress)
    show(report, check_parts(report), as_json)


@app.command()
def info(model: ModelFile, as_json: AsJson = False) -> None:
    """What a model file holds: parameters with units and ranges, terms, accuracy, versions."""
    if kind_of(model) == rod.KIND:
        finger = Rod.load(model)
        show(rod_summary(finger), finger.tables(), as_json)
    known = Surrogate.load(model)
    show(summary(known), known.tables(), as_json)


@app.command("export")
def export_model(
    model: ModelFile,
    output: Annotated[Path, typer.Argument(metavar="FINGER.h|FINGER.fmu", help="A C header or an FMU, by its ending.")],
    tolerance: Annotated[
        float, typer.Option(min=0, max=0.5, help="Keep only the terms this relative error needs.")
    ] = 0.0,
    fmi: Annotated[int, typer.Option(metavar="2|3", help="Version of FMI of an FMU.")] = 3,
    controller: Annotated[
        bool, typer.Option("--controller", help="An FMU that holds a contact force: tensions come out.")
    ] = False,
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
            raise ValueError(f"output must be named .h or .fmu, got {output}; rom page writes .html")
        if controller or fmi != 3:
            raise ValueError(f"output must be named .fmu for --fmi and --controller, got {output}")
        export(known, output)
        say(f"{output}: {output.stat().st_size / 1e6:.1f} MB; its first lines describe it")
        return
    from rom.export.fmu import write

    write(known, output, fmi, controller)
    say(f"{output}: FMI {fmi}.0 for co-simulation, {output.stat().st_size / 1e6:.1f} MB")


@app.command()
def page(
    model: ModelFile,
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FINGER.html")],
    tolerance: Annotated[
        float, typer.Option(min=0, max=0.5, help="Keep only the terms this relative error needs.")
    ] = 0.0,
) -> None:
    """Write a page for a browser: the finger bends as sliders move, offline and with nothing but the file."""
    from rom.export.page import write

    check_folder(output)
    write(load(model, tolerance), output)
    say(f"{output}: {output.stat().st_size / 1e6:.1f} MB; open it in a browser")


if __name__ == "__main__":
    run(app)
