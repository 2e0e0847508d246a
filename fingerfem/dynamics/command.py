"""python3 -m fingerfem simulate | modes."""

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

import fingerfem
from fingerfem.equilibrium.failures import NotConverged
from fingerfem.output.rows import finish
from rom.console.interruption import interruptible
from rom.console.packages import SOLVING, require
from rom.console.program import NOTHING_USABLE
from rom.console.terminal import say, steps

SceneFile = Annotated[Path, typer.Argument(metavar="SCENE.toml", help="The scene, with densities.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object on stdout.")]


def simulate(
    scene_file: SceneFile,
    motion_file: Annotated[
        Path, typer.Argument(metavar="MOTION.toml", help="Loads, motion of the base, steps, by time.")
    ],
    output: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="OUT/", help="Folder of motion.csv and motion.png; resumed if begun."),
    ],
    as_json: AsJson = False,
) -> None:
    """Move a finger in time with the full-order model: inertia, viscoelastic branches, impacts.

    After an interruption, the same command continues. A step that fails is repeated smaller.
    """
    require(*SOLVING, "matplotlib")
    from fingerfem.dynamics.generalised_alpha import MotionStopped
    from fingerfem.dynamics.motion import read_motion
    from fingerfem.dynamics.plots import write_motion
    from fingerfem.dynamics.records import Records
    from fingerfem.dynamics.simulation import Simulation

    _check_ranks()
    scene = fingerfem.load_scene(scene_file)
    motion = read_motion(motion_file, scene)
    simulation = Simulation(scene, motion)
    interruptible(f"stopped by Ctrl-C: {output} has the motion until now; run the same command again")
    reason = None
    with Records(output, motion.digest) as records, steps() as progress:

        def report(row: dict[str, float], moment: Any) -> None:
            records(row, moment)
            progress("thousandths of the motion", int(1000 * row["time"] / motion.time.end), 1000)

        try:
            simulation.run(report, records.moment)
        except MotionStopped as failure:
            reason = str(failure)
            say(reason)
    found: dict[str, Any] = {"converged": reason is None, "steps": max(len(records.rows) - 1, 0)}
    if records.rows:
        write_motion(records.rows, output / "motion.png")
        found |= {name: None if np.isnan(value) else value for name, value in records.rows[-1].items()}
    finish(found | ({} if reason is None else {"reason": reason}), as_json, 0 if reason is None else NOTHING_USABLE)


def modes(
    scene_file: SceneFile,
    loads: Annotated[
        list[str] | None, typer.Argument(help="F1=50 F2=0 [N], p1=20e3 [Pa], d=0.005 [m] (or no plane).")
    ] = None,
    count: Annotated[int, typer.Option(min=1, help="How many.")] = 6,
    instantaneous: Annotated[
        bool, typer.Option("--instantaneous", help="Viscoelastic branches as stiff as at once, in place of relaxed.")
    ] = False,
    picture: Annotated[Path | None, typer.Option(help="Also draw the modes, a .png, .svg or .pdf.")] = None,
    paraview: Annotated[Path | None, typer.Option(help="Also write them for ParaView, a .vtu file.")] = None,
    as_json: AsJson = False,
) -> None:
    """Natural frequencies and modes about the equilibrium at these loads, of the whole finger."""
    drawn = (*(() if picture is None else ("matplotlib",)), *(() if paraview is None else ("pyvista",)))
    require(*SOLVING, *drawn)
    from fingerfem.dynamics.modes import ModalAnalysis
    from fingerfem.scene.loads import read_loads

    _check_ranks()
    scene = fingerfem.load_scene(scene_file)
    asked = read_loads(scene, loads or [])
    if np.any(asked.pop("wrenches", 0.0)):
        raise ValueError("loads must be tensions alone for modes: loads that follow the plates have none, got wrenches")
    analysis = ModalAnalysis(scene)
    try:
        found = analysis.solve(**asked, count=count, instantaneous=instantaneous)
    except NotConverged as failure:
        finish({"converged": False, "reason": failure.reason}, as_json, NOTHING_USABLE)
    if picture is not None:
        from fingerfem.dynamics.plots import write_modes

        write_modes(found, picture)
    if paraview is not None:
        from fingerfem.dynamics.plots import write_mode_fields

        write_mode_fields(analysis.problem, found, paraview)
    named = {f"mode_{k + 1}": title for k, title in enumerate(found.titles)}
    finish({"converged": True} | (found.as_json() if as_json else named | {"mass": found.mass}), as_json)


def _check_ranks() -> None:
    """Refuse several ranks, of which each would do the same."""
    from mpi4py import MPI

    if MPI.COMM_WORLD.size > 1:
        raise ValueError(f"motion and modes must be of one rank, got {MPI.COMM_WORLD.size}")
