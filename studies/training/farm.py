"""Training, measured: two ranks against one, what the farm costs, restart and memory."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np

from studies.parts import Run
from studies.sets import farm, grid_scene

SHORT, LONG = (5, 6), (8, 8)  # nodes of tensions and of contact


def scaling(folder: Path) -> dict:
    """One rank and two on the same set, one after the other."""
    file, rates = grid_scene(folder, *SHORT), {}
    for ranks in (1, 2):
        shutil.rmtree(folder / "set", ignore_errors=True)
        report = farm(ranks, file, folder / "set")
        # From the first claim to the last: a job's start is counted apart.
        rates[ranks] = report["states"] / report["this_rank"]["seconds"]
        if ranks == 1:
            overhead = 1 - report["this_rank"]["solve_seconds"] / report["this_rank"]["seconds"]
    return {
        "states": report["states"],
        "states_per_second": rates,
        "two_over_one": rates[2] / rates[1],
        "farm_overhead": overhead,
        "start_seconds": report["wall_seconds"] - report["this_rank"]["seconds"],
        "bytes_per_state": report["bytes_per_state"],
        "newton_iterations_per_state": report["newton_iterations"] / report["states"],
    }


def long_run(folder: Path) -> dict:
    """Memory while a set is solved, and its restart once it is whole."""
    file, path = grid_scene(folder, *LONG), folder / "long"
    shutil.rmtree(path, ignore_errors=True)
    report = farm(2, file, path)
    memory = [max(sizes.values()) for sizes in report["memory"] if sizes]
    part = len(memory) // 4
    return {
        "states": report["states"],
        "states_per_rank": report["states"] // 2,
        "memory_after_a_quarter": float(np.median(memory[part : part + max(part // 4, 1)])),
        "memory_at_the_end": float(np.median(memory[-max(part // 4, 2) : -1])),
        "restart_seconds": farm(1, file, path)["wall_seconds"],
    }


def measure(run: Run) -> dict:
    """Both sets."""
    return {
        "scaling": run.once("two ranks against one", scaling, run.folder),
        "long_run": run.once("a long run and its restart", long_run, run.folder),
    }
