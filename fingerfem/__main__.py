"""python3 -m fingerfem solve | snapshots | render."""

from __future__ import annotations

import json
import logging
import os
import sys
import time
from pathlib import Path
from typing import Annotated

import typer

from fingerfem import LoadNotReached, load_scene

app = typer.Typer(add_completion=False, no_args_is_help=True, rich_markup_mode=None, pretty_exceptions_enable=False)
BAD_INPUT, NOTHING_USABLE = 2, 3
SceneFile = Annotated[Path, typer.Argument(metavar="SCENE.toml", help="The scene.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object on stdout.")]


def read_loads(scene, settings: list[str]) -> tuple[list[float], float | None]:
    """Tensions [N] and distance [m] from words like F1=50; what is left out is 0 N, or no plane.

    Raises:
        ValueError: name, rule, value.
    """
    names = [parameter["name"] for parameter in scene.parameters]
    values: dict[str, float] = {}
    for setting in settings:
        name, equals, text = setting.partition("=")
        if not equals or name not in names or name in values:
            raise ValueError(f"loads must be NAME=VALUE, once each, with NAME one of {', '.join(names)}, got {setting}")
        try:
            values[name] = float(text)
        except ValueError:
            raise ValueError(f"{name} must be a number, got {text!r}") from None
    return [values.get(tendon.name, 0.0) for tendon in scene.tendons], values.get("d")


@app.command()
def solve(
    scene_file: SceneFile,
    loads: Annotated[
        list[str] | None, typer.Argument(help="F1=50 F2=0 [N], d=0.005 [m]; d left out: no plane.")
    ] = None,
    as_json: AsJson = False,
    picture: Annotated[Path | None, typer.Option(help="Also write a picture, coloured by S11.")] = None,
    paraview: Annotated[Path | None, typer.Option(help="Also write the fields for ParaView, a .vtu file.")] = None,
) -> None:
    """Solve one state from rest with the full-order model; under mpirun the ranks share the finger."""
    from mpi4py import MPI

    from fingerfem import FingerModel

    comm = MPI.COMM_WORLD
    scene = load_scene(scene_file)
    tensions, distance = read_loads(scene, loads or [])
    for file, option in ((picture, "picture"), (paraview, "paraview")):
        if file is not None and comm.size > 1:
            raise ValueError(f"{option} must be written by one rank, got {comm.size}")
    model = FingerModel(scene, comm)
    try:
        state = model.solve(tensions, distance)
    except LoadNotReached as failure:
        reached = {"tensions": failure.tensions.tolist(), "distance": failure.distance}
        answer = {"converged": False, "reason": str(failure), "last_good_load": reached}
        _finish(answer, as_json, NOTHING_USABLE, comm.rank)
    if state.self_intersecting and comm.rank == 0:
        print("the finger passes through itself: contact with itself is not modelled", file=sys.stderr)
    if not state.stable and comm.rank == 0:
        print("the equilibrium is not stable: the finger would leave it", file=sys.stderr)
    if picture is not None:
        from fingerfem.render import Deformed, draw

        draw([Deformed.of(model, state)], picture)
    if paraview is not None:
        from fingerfem.output import write_vtu

        write_vtu(model, state, paraview)
    _finish(state.as_json(), as_json, rank=comm.rank)


@app.command()
def snapshots(
    scene_file: SceneFile,
    folder: Annotated[Path, typer.Argument(metavar="SET/", help="The set's folder; begun if new, finished if not.")],
    random: Annotated[int, typer.Option(min=0, help="How many held-out points, instead of training nodes.")] = 0,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the held-out points.")] = 0,
    bar: Annotated[
        bool, typer.Option(help="A progress bar also where stderr is no terminal, as under mpirun.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Solve what is missing of a snapshot set; run it under mpirun, as often as needed."""
    os.environ.setdefault("OMPI_MCA_async_mpi_finalize", "1")  # or Open MPI would wait at its end for killed ranks
    import petsc4py
    from mpi4py import MPI

    petsc4py.init(comm=MPI.COMM_SELF)  # and so would PETSc
    from fingerfem import FingerModel
    from fingerfem import snapshots as farm
    from fingerfem.sampling import HeldOut, describe
    from fingerfem.versions import versions
    from rom.snapshots import SnapshotSet

    comm = MPI.COMM_WORLD
    logging.basicConfig(
        level=logging.INFO if comm.rank == 0 else logging.WARNING, format="%(message)s", stream=sys.stderr
    )
    scene = load_scene(scene_file)
    description = describe(scene, versions(), HeldOut(count=random, seed=seed) if random else None)
    model = FingerModel(scene)
    begun = time.perf_counter()
    with _progress(len(description.tasks), comm.rank == 0, bar) as advance:
        solved = farm.run(description, model, folder, advance)
    if comm.rank != 0:
        return
    result = SnapshotSet(folder)
    failures = [f"{task} {parameters.tolist()}: {reason}" for task, parameters, reason in result.failures]
    for line in failures:
        logging.warning("failed: %s", line)
    if failures:
        logging.warning(
            "to try failed states again, delete their tasks in %s and run this command again", folder / "tasks"
        )
    report = {
        "tasks": len(description.tasks),
        "solved_by_this_rank": solved,
        "states": result.states,
        "failed": len(failures),
        "newton_iterations": result.iterations,
        "seconds": time.perf_counter() - begun,
        "ranks": comm.size,
    }
    _finish(report, as_json, NOTHING_USABLE if failures and not (random and result.states > len(failures)) else 0)


def _progress(total: int, shown: bool, forced: bool):
    """A bar on a terminal, a plain line now and then elsewhere."""
    from contextlib import contextmanager

    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True, force_terminal=forced or None)

    @contextmanager
    def bar():
        if not shown:
            yield lambda done: None
        elif console.is_terminal:
            columns = TextColumn("lines of states"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
            with Progress(*columns, console=console) as progress:
                task = progress.add_task("", total=total)
                yield lambda done: progress.update(task, completed=done)
        else:
            said = [-1]

            def say(done: int) -> None:
                if done * 10 // total > said[0]:
                    said[0] = done * 10 // total
                    logging.info("%d of %d lines of states", done, total)

            yield say

    return bar()


@app.command()
def render(
    scene_file: SceneFile,
    picture: Annotated[Path, typer.Argument(metavar="PICTURE.png")],
    case: Annotated[list[str], typer.Option(help="One load case, such as 'F1=50 d=0.005'; may be repeated.")],
    field: Annotated[str, typer.Option(help="S11, von_mises or J.")] = "S11",
) -> None:
    """Draw deformed fingers coloured by a field of the rubber, one panel a load case."""
    from fingerfem import FingerModel
    from fingerfem.render import Deformed, draw

    scene = load_scene(scene_file)
    cases = [read_loads(scene, words.split()) for words in case]
    model = FingerModel(scene)
    panels = []
    for tensions, distance in cases:
        panels.append(Deformed.of(model, model.solve(tensions, distance, sensitivities=False), field))
    draw(panels, picture)


def _finish(result: dict, as_json: bool, code: int = 0, rank: int = 0) -> None:
    if rank != 0:
        raise SystemExit(code)
    if as_json:
        print(json.dumps(result))
    else:
        for name, value in result.items():
            print(f"{name:24s} {value}")
    raise SystemExit(code)


def main() -> None:
    """Run the command; bad input is one line and exit code 2, no equilibrium one line and 3."""
    try:
        app()
    except (ValueError, OSError, LoadNotReached) as error:
        # All ranks of a job stop for the same reason; one of them says so.
        if os.environ.get("OMPI_COMM_WORLD_RANK", os.environ.get("PMIX_RANK", "0")) == "0":
            print(error, file=sys.stderr)
        raise SystemExit(NOTHING_USABLE if isinstance(error, LoadNotReached) else BAD_INPUT) from None


if __name__ == "__main__":
    main()
