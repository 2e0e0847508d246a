"""Write docs/training.md and its picture from what studies/training/training.py, refinement.py and solver.py measured.

python3 studies/training/page.py out/farm out/solver/solver.json
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from studies.readme import table
from studies.training.refinement import as_good

RANKS = (1, 8, 64, 1000)
STATES = (1_000, 10_000)
DRAFT = [25, 6]  # cells of the row of the solver's study that is nearest to the draft finger


def seconds_a_state(found: dict, sizes: list[dict]) -> list[tuple[int, float]]:
    """Unknowns and seconds a state on one core: the draft's, and in proportion to a factorisation's time on other meshes."""
    draft = next(row for row in sizes if row["cells"] == DRAFT)
    each = 1 / found["scaling"]["states_per_second"]["1"]

    def factorisation(row: dict) -> float:
        return row["seconds"] / row["factorisations"]

    return [(row["unknowns"], each * factorisation(row) / factorisation(draft)) for row in sizes]


def duration(seconds: float) -> str:
    """For people."""
    if seconds < 120:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.0f} h"


def projection(found: dict, sizes: list[dict]) -> str:
    """How long sets take, by mesh, states and ranks."""
    start = found["scaling"]["start_seconds"]
    header = [
        "unknowns",
        "s a state, one core",
        *(f"{n:,} states, {ranks:,} rank{'s' if ranks > 1 else ''}" for n in STATES for ranks in RANKS),
    ]
    rows = []
    for unknowns, each in seconds_a_state(found, sizes):
        times = [duration(start + each * states / ranks) for states in STATES for ranks in RANKS]
        rows.append([f"{unknowns:,}", f"{each:.2g}", *times])
    return table(header, rows)


def refining(found: dict) -> str:
    """Uniform grids beside the refined set."""
    names = ["force_median", "force_p95", "displacement_median", "displacement_p95"]

    def numbers(row: dict) -> list[str]:
        return [f"{row['states']:,}", f"{row['newton_iterations']:,}", *(f"{100 * row[name]:.2g} %" for name in names)]

    def part(row: dict, measures: list[str]) -> str:
        good = as_good(row, found["refined"], measures)
        return f"{good['states']} ({good['of_the_uniform_grid']:.2f})" if good else "none of these"

    tails = [name for name in names if name.endswith("p95")]
    header = ["states", "iterations", "force, median", "95 %", "displacement, median", "95 %"]
    uniform = [
        [
            f"{row['tension_nodes']} x {row['contact_nodes']}",
            *numbers(row),
            part(row, tails),
            part(row, [*tails, "force_median"]),
            part(row, names),
        ]
        for row in found["uniform"]
    ]
    refined = [[str(row["round"]), f"{100 * row['estimated_error']:.2g} %", *numbers(row)] for row in found["refined"]]
    return "\n\n".join(
        (
            table(
                ["uniform grid", *header, "refined, as good in both 95 %", "and in force's median", "in all four"],
                uniform,
            ),
            table(["refined, round", "estimated", *header], refined),
        )
    )


def reusing(found: dict) -> str:
    """Grids solved from the states of coarser ones."""
    rows = [
        [
            row["for"],
            row["of"],
            f"{row['newton_iterations']:,}",
            f"{row['alone']:,}",
            f"{row['newton_iterations'] / row['alone']:.2f}",
        ]
        for row in found["reused"]
    ]
    return table(["uniform grid", "with the states of", "iterations", "alone", "ratio"], rows)


def draw(found: dict, picture: Path) -> None:
    """Held-out error against states."""
    import matplotlib

    matplotlib.use("agg")
    from matplotlib import pyplot

    figure, panels = pyplot.subplots(1, 2, figsize=(9, 3.6), layout="constrained", sharex=True)
    for panel, (name, title) in zip(
        panels, (("force", "contact force"), ("displacement", "displacement")), strict=True
    ):
        for rows, label, style in ((found["uniform"], "uniform", "s-"), (found["refined"], "refined", "o-")):
            rows = sorted(rows, key=lambda row: row["states"])
            states = [row["states"] for row in rows]
            (line,) = panel.loglog(states, [100 * row[f"{name}_p95"] for row in rows], style, label=f"{label}, 95 %")
            values = [100 * row[f"{name}_median"] for row in rows]
            panel.loglog(states, values, style, color=line.get_color(), mfc="none", alpha=0.6, label=f"{label}, median")
        panel.set_title(f"{title}: relative error on {found['held_out']} held-out states [%]", fontsize="medium")
        panel.set_xlabel("training states")
        panel.grid(True, which="both", alpha=0.25)
    panels[0].legend(fontsize="small")
    figure.savefig(picture, dpi=110)


def page(found: dict, refinement: dict, sizes: list[dict]) -> str:
    """The page's text."""
    scaling, long_run = found["scaling"], found["long_run"]
    claims = table(
        ["processes", "lines claimed and written a second", "in all"],
        [[str(row["processes"]), f"{row['lines_per_second']:.0f}", f"{row['lines']:,}"] for row in found["contention"]],
    )
    needed = 1000 / (13 / scaling["states_per_second"]["1"])
    return f"""# Training

Numbers written by `make training` from `studies/training/training.py`, on {found["cores"]} cores.

## How long a set takes

The draft finger, {scaling["states"]:,} states, {scaling["newton_iterations_per_state"]:.1f} Newton iterations and {scaling["bytes_per_state"]:,} bytes a state. Two ranks solve
**{scaling["two_over_one"]:.2f} times** the states per second of one; claims, files and waiting take **{scaling["farm_overhead"]:.2%}** of a rank's time.
A job starts in {scaling["start_seconds"]:.1f} s, and finds a whole set of {long_run["states"]:,} states whole in **{long_run["restart_seconds"]:.1f} s**. While a rank solved {long_run["states_per_rank"]:,}
states, its memory went from {long_run["memory_after_a_quarter"]:.0f} MB (after a quarter) to {long_run["memory_at_the_end"]:.0f} MB.

From these and from the time of a factorisation on finer meshes ([solver.md](solver.md)), one rank a finger; **projected, not measured**,
and with as many lines of states as ranks or more:

{projection(found, sizes)}

Lines that are claimed and written while nothing is solved, by as many processes, which is as fast as the farm itself can be:

{claims}

A thousand ranks on draft states, the fastest there are, would ask for {needed:.0f} lines a second; on the paper's mesh for some {needed / 20:.0f}.

## Where the error is: `--until` and `--budget`

`snapshots SCENE.toml SET/ --until 0.01` does not solve a uniform grid. It begins with a coarse one and adds lines of states, round by
round, where the surrogate doubts itself most, until the error it estimates for 95 % of the box is below the tolerance; `--budget 30min`
ends it sooner, and the same command goes on. The doubt is the difference between two interpolations of the states and their
derivatives, cubic and of degree 7: it costs no solve. What is left of the grid is filled in by the better of the two.

On the draft finger, against {refinement["held_out"]} held-out states (contact force where it touches; models of up to 160 terms, so that
sampling makes the error):

![held-out error against states](refinement.png)

{refining(refinement)}

In brackets: its states over those of the uniform grid. A refined set evens out the error: it gains most where the worst states are, less
in the median. Its lines are shorter, so a state takes more iterations than on a uniform grid.

A finer uniform grid takes the states of a coarser one whose nodes it holds: `snapshots FINE.toml SET2/ --reuse SET/`. Nodes nest where the
number of intervals doubles (9, 17, 33 along a tension; 12, 23 along contact).

{reusing(refinement)}

## Where it runs

- **One machine**: `mpirun --enable-recovery -n CORES python3 -m fingerfem snapshots SCENE.toml SET/`, as often as needed.
- **Slurm with Apptainer**: `docker/cluster/apptainer.def` makes the image of the Dockerfile's train target, `sbatch
  docker/cluster/slurm.sh SCENE.toml SET/` trains. Submit it several times: jobs share a set.
- **Several machines that share a folder**: `docker/cluster/multinode.sh HOSTFILE SCENE.toml SET/`.
- **A finger too large for one core**: `--ranks-per-finger 4`. A rank that dies then takes its group along; use plain mpirun.

Compiled forms belong on a disk of the machine's own (`XDG_CACHE_HOME`), sets on the shared one. Where a file system has no working
locks, as some cluster mounts, the farm notices, says so, and claims by files that their owners keep touching.

## What can go wrong, and what becomes of it

| what | what becomes of it |
| --- | --- |
| a rank or a job is killed | the lines of states at hand are lost, and solved by others or by the next job |
| SIGTERM | the line at hand is dropped; it does not count as a death |
| a line at which three processes died | quarantined: its states count as failed; `retry` tries again |
| a state without equilibrium, unstable, or through itself | failed, with its reason and the last good load; it never reaches the surrogate |
| full disk, folder that cannot be written to | one line, exit code 2; what was written is whole |
| truncated or foreign files in the set | moved to `set-aside/` and solved again |
| another scene, other nodes, other versions | refused in one line |
| a failed or missing state that refines | the surrogate is built without it, and says so; of the first grid, it is not built |
| a compilation that was killed, jobs that compile at once | nothing: a form is compiled in a folder of its own and renamed when it is whole |
| a clock that jumps | nothing: no clock of the wall is used |

Each is tried by `tests/fingerfem/snapshots/test_disasters.py`.
"""


def main(farm: Path, solver: Path) -> None:
    """Write the page."""
    training, refinement = (json.loads((farm / f"{name}.json").read_text()) for name in ("training", "refinement"))
    draw(refinement, ROOT / "docs" / "refinement.png")
    sizes = [row for row in json.loads(solver.read_text())["sizes"] if "failed" not in row]
    (ROOT / "docs" / "training.md").write_text(page(training, refinement, sizes))


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
