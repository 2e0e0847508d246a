"""fingerfem: solve, simulate, modes, certify, snapshots, status, retry, render, sketch, fit-material, doctor."""

from rom.console.program import NOTHING_USABLE, begin, one_line

if __name__ == "__main__":
    begin()

import atexit
import json
import logging
import math
import os
import signal
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

import fingerfem
from fingerfem.dynamics.command import modes, simulate
from fingerfem.equilibrium.failures import LoadNotReached
from fingerfem.material_fit.command import fit_material
from fingerfem.output.rows import check_ending, finish
from fingerfem.scene.amounts import seconds as duration
from fingerfem.scene.amounts import share
from rom.console.interruption import first_rank, interruptible
from rom.console.packages import DRAWING, SOLVING, require
from rom.console.terminal import log_lines, say

app = typer.Typer(add_completion=False, no_args_is_help=True, rich_markup_mode=None, pretty_exceptions_enable=False)
KEPT = "stopped by {}: solved states are kept; run the same command again"
CALLER = "FINGERFEM_CALLER"  # variable of a program that calls the farm and says itself why it was stopped
SceneFile = Annotated[Path, typer.Argument(metavar="SCENE.toml", help="The scene.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object on stdout.")]


@app.command()
def solve(
    scene_file: SceneFile,
    loads: Annotated[
        list[str] | None,
        typer.Argument(help="F1=50 F2=0 [N], p1=20e3 [Pa], d=0.005 [m] (or no plane), fx=1 my=0.01 [N, N m]."),
    ] = None,
    as_json: AsJson = False,
    picture: Annotated[Path | None, typer.Option(help="Also write a picture, coloured by S11.")] = None,
    paraview: Annotated[Path | None, typer.Option(help="Also write the fields for ParaView, a .vtu file.")] = None,
) -> None:
    """Solve one state from rest with the full-order model; under mpirun the ranks share the finger."""
    require(*SOLVING, *(DRAWING if picture is not None or paraview is not None else ()))
    from mpi4py import MPI

    from fingerfem.scene.loads import read_loads

    comm = MPI.COMM_WORLD
    scene = fingerfem.load_scene(scene_file)
    asked = read_loads(scene, loads or [])
    for file, option, ending in ((picture, "picture", ".png"), (paraview, "paraview", ".vtu")):
        check_ending(option, file, ending)
        if file is not None and comm.size > 1:
            raise ValueError(f"{option} must be written by one rank, got {comm.size}")
    model = fingerfem.FingerModel(scene, comm)
    try:
        state = model.solve(**asked)
    except LoadNotReached as failure:
        answer = {"converged": False, "reason": str(failure), "last_good_load": failure.reached}
        finish(answer, as_json, NOTHING_USABLE, comm.rank)
    if comm.rank == 0:
        for mark in state.marks:
            say(mark)
    if picture is not None:
        from fingerfem.output.pictures import Deformed, draw

        draw([Deformed.of(model, state)], picture)
    if paraview is not None:
        from fingerfem.output.paraview import write_vtu

        write_vtu(model, state, paraview)
    finish(state.as_json(), as_json, rank=comm.rank, parts=state.tables())


@app.command()
def certify(
    model_file: Annotated[
        Path, typer.Argument(metavar="MODEL.h5", help="A table of full-order states, or a finger of elements.")
    ],
    loads: Annotated[list[str] | None, typer.Argument(help="F1=50 F2=0 [N], d=0.005 [m] (or no plane).")] = None,
    as_json: AsJson = False,
) -> None:
    """Compare a model's answer with that of the full-order model at the same loads."""
    require(*SOLVING)
    from fingerfem.certify import Certifier
    from fingerfem.scene.loads import read_loads
    from rom import load

    certifier = Certifier(load(model_file))
    certificate = certifier.certify(**read_loads(certifier.full_order.scene, loads or []))
    for mark in certificate.marks:
        say(mark)
    finish(certificate.as_json(), as_json, 0 if certificate.covered else NOTHING_USABLE)


@app.command()
def snapshots(
    scene_file: SceneFile,
    folder: Annotated[Path, typer.Argument(metavar="SET/", help="The set's folder; begun if new, finished if not.")],
    random: Annotated[int, typer.Option(min=0, help="How many held-out points, instead of training nodes.")] = 0,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the held-out points.")] = 0,
    distances: Annotated[
        int, typer.Option(min=1, help="Distances of the plane at each held-out point's tensions: cheaper by the state.")
    ] = 1,
    points: Annotated[
        Path | None, typer.Option(metavar="POINTS.csv", help="Held-out points of your own: F1,F2,d and lines of them.")
    ] = None,
    ranks_per_finger: Annotated[int, typer.Option(min=1, help="Ranks that solve one finger together.")] = 1,
    until: Annotated[
        str | None,
        typer.Option(help='With a load: add lines until the expected error of the force is "1 %" or 0.01.'),
    ] = None,
    budget: Annotated[
        str | None, typer.Option(help="With a load: add lines for 90s, 30min or 2h, then finish current lines.")
    ] = None,
    reuse: Annotated[
        Path | None,
        typer.Option(metavar="SET/", help="Take the states that another grid of the same finger has."),
    ] = None,
    near: Annotated[
        Path | None,
        typer.Option(
            metavar="SET/",
            help="Begin held-out or pressed states at those of another set of the same finger, of any mesh.",
        ),
    ] = None,
    coarse: Annotated[
        bool, typer.Option("--coarse", help="Solve on the scene's coarse mesh, in place of its own.")
    ] = False,
    progress: Annotated[
        str, typer.Option(help="bar, plain or json lines on stderr; auto: a bar on a terminal, which mpirun is not.")
    ] = "auto",
    as_json: AsJson = False,
) -> None:
    """Solve what is missing of a snapshot set; run it under mpirun, as often as needed.

    Before a plane or in free space, a training set is a grid of tension_nodes and contact_nodes. With a load, it has
    lines of pressed states.
    """
    os.environ.setdefault("OMPI_MCA_async_mpi_finalize", "1")  # or Open MPI would wait at its end for killed ranks
    require(*SOLVING)
    import petsc4py
    from mpi4py import MPI

    # PETSc, too, would wait for killed ranks; and its signal handlers hang in MPI_Abort where mpirun itself is gone.
    petsc4py.init(["-no_signal_handler"], comm=MPI.COMM_SELF)
    from fingerfem.snapshots.design import HeldOut
    from fingerfem.snapshots.given_points import GivenPoints
    from fingerfem.snapshots.job import Job, Request
    from fingerfem.snapshots.progress import STYLES

    world = MPI.COMM_WORLD
    log_lines(logging.INFO if world.rank == 0 else logging.ERROR)
    if progress not in STYLES:
        raise ValueError(f"progress must be one of {', '.join(STYLES)}, got {progress}")
    if world.size % ranks_per_finger:
        raise ValueError(f"ranks-per-finger must divide the number of ranks, {world.size}, got {ranks_per_finger}")
    if random and points is not None:
        raise ValueError(f"random must not be given with points, got {random}")
    if distances > 1 and not random:
        raise ValueError(f"distances must be given with random, got {distances}")
    scene = fingerfem.load_scene(scene_file)
    if world.rank == 0 and scene.expected is not None and not random:
        logging.info("expected: %s", scene.expected)
    if coarse:
        scene = scene.on_coarse_mesh()
    held_out: HeldOut | GivenPoints | None = None if points is None else GivenPoints(points)
    if random:
        held_out = HeldOut(count=random, seed=seed, distances=distances)
    request = Request(
        scene=scene,
        folder=folder,
        held_out=held_out,
        until=None if until is None else share("until", until),
        budget=duration("budget", budget) if budget is not None else math.inf,
        reuse=reuse,
        near=near,
    )
    job = Job(request=request, world=world, ranks_per_finger=ranks_per_finger)
    signal.signal(signal.SIGCONT, lambda *_: None)  # comes before SIGTERM: fingerfem.snapshots.ledger
    if ranks_per_finger == 1:
        signal.signal(signal.SIGTERM, _terminated)
        interruptible(KEPT.format("Ctrl-C"))
    else:  # no rank may leave its contexts while others wait for it in MPI: they end at once
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda asked, _: os._exit(128 + asked))
    summary = job.run(progress)
    if job.is_first:
        finish(summary, as_json, NOTHING_USABLE if job.is_unusable else 0)


def _terminated(*_) -> None:
    """SIGTERM, by a scheduler or by mpirun at Ctrl-C: drop the current line of states, give back its claim, and end."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    if first_rank() and CALLER not in os.environ:
        # mpirun, when it is interrupted, passes nothing on.
        parallel = "OMPI_COMM_WORLD_RANK" in os.environ
        line = KEPT.format("Ctrl-C or SIGTERM" if parallel else "SIGTERM")
        atexit.register(say, line, terminal=parallel)
    raise SystemExit(128 + signal.SIGTERM)


SetFolder = Annotated[Path, typer.Argument(metavar="SET/", help="The set's folder.")]


@app.command()
def status(folder: SetFolder, as_json: AsJson = False) -> None:
    """Report the result of every state of a snapshot set, also while jobs work on it."""
    from fingerfem.snapshots.ledger import Ledger, sentence
    from rom.dataset.snapshot_set import read_description

    description = read_description(folder)
    ledger = Ledger(folder, description)
    ledger.refresh()
    summary = ledger.summary()
    if as_json:
        summary["failures"] = [
            {"task": task, "parameters": parameters.tolist(), "last_good": last_good.tolist(), "reason": reason}
            for task, parameters, last_good, reason in ledger.failures
        ]
    else:
        for failure in ledger.failures:
            print(sentence(description, *failure))
    finish(summary, as_json)


@app.command()
def retry(folder: SetFolder) -> None:
    """Clear the lines of a set with failed or quarantined states, so that snapshots solves them again."""
    from fingerfem.snapshots.ledger import Ledger
    from rom.dataset.snapshot_set import read_description

    ledger = Ledger(folder, read_description(folder))
    ledger.refresh()
    print(f"{len(ledger.forget_failures())} lines will be solved again")


@app.command()
def doctor(as_json: AsJson = False) -> None:
    """Report what this installation has, what is wrong with it, and how to mend it."""
    from fingerfem.doctor import examine, report

    findings = list(examine()) if as_json else report()
    wrong = [finding.name for finding in findings if finding.verdict == "wrong"]
    if as_json:
        print(json.dumps({"wrong": wrong, "findings": [asdict(finding) for finding in findings]}))
    raise SystemExit(NOTHING_USABLE if wrong else 0)


@app.command()
def render(
    scene_file: SceneFile,
    picture: Annotated[Path, typer.Argument(metavar="PICTURE.png")],
    case: Annotated[list[str], typer.Option(help="One load case, such as 'F1=50 d=0.005'; may be repeated.")],
    field: Annotated[str, typer.Option(help="S11, von_mises or J.")] = "S11",
) -> None:
    """Draw deformed fingers coloured by a field of the rubber, one panel a load case."""
    require(*SOLVING, *DRAWING)
    from fingerfem.output.pictures import Deformed, draw
    from fingerfem.scene.loads import read_loads

    check_ending("picture", picture, ".png")
    scene = fingerfem.load_scene(scene_file)
    cases = [read_loads(scene, words.split()) for words in case]
    model = fingerfem.FingerModel(scene)
    draw([Deformed.of(model, model.solve(**loads, sensitivities=False), field) for loads in cases], picture)


@app.command()
def sketch(
    scene_file: SceneFile, picture: Annotated[Path, typer.Argument(metavar="OUT.png", help="Or .svg, .pdf.")]
) -> None:
    """Draw a scene's finger at rest, with its measures: axes, segments, plates, tendons, plane and pad."""
    from fingerfem.output.sketch import write_sketch

    write_sketch(fingerfem.load_scene(scene_file), picture)


app.command()(fit_material)
app.command()(simulate)
app.command()(modes)


def main() -> None:
    """Run the command; bad input is one line and exit code 2, no equilibrium one line and 3."""
    with one_line(LoadNotReached):
        app()


if __name__ == "__main__":
    main()
