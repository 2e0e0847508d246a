"""Training, measured: two ranks against one, what the farm costs, and its restart."""

from __future__ import annotations

import shutil
from pathlib import Path

from studies.parts import Run
from studies.sets import farm, grid_scene

NODES = (6, 6)  # of tensions and of contact


def scaling(folder: Path) -> dict:
    """One rank and two on the same set, one after the other, and a job that finds it complete."""
    file, reports = grid_scene(folder, *NODES), []
    for ranks in (1, 2):
        shutil.rmtree(folder / "set", ignore_errors=True)
        reports.append(farm(ranks, file, folder / "set"))
    restart = farm(1, file, folder / "set")
    # From the first claim to the last: a job's start is counted apart.
    one, two = (report["states"] / report["this_rank"]["seconds"] for report in reports)
    alone = reports[0]
    return {
        "states": alone["states"],
        "two_over_one": two / one,
        "farm_overhead": 1 - alone["this_rank"]["solve_seconds"] / alone["this_rank"]["seconds"],
        "start_seconds": alone["wall_seconds"] - alone["this_rank"]["seconds"],
        "restart_seconds": restart["wall_seconds"],
        "bytes_per_state": alone["bytes_per_state"],
        "iterations_per_state": alone["newton_iterations"] / alone["states"],
    }


def measure(run: Run) -> dict:
    """One row."""
    return run.once("two ranks against one", scaling, run.folder)
