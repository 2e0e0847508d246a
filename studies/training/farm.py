"""Training, measured: two ranks against one, what the farm costs, restart, memory, claims of 64 ranks at once."""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from rom.dataset.folder import create
from rom.dataset.snapshot_set import read_description
from studies.parts import ROOT, Run
from studies.sets import farm, grid_scene

LINES, PROCESSES = 2000, (1, 8, 64)  # lines that are claimed; processes that claim at once
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


def contention(folder: Path, processes: int) -> dict:
    """Processes that claim and write lines without solving any: the farm's own limit."""
    ours, theirs = folder / "claims", folder / "set"
    shutil.rmtree(ours, ignore_errors=True)
    others = [0.0] * (len(read_description(theirs).parameters) - 1)
    points = [[1e-3 * k, *others] for k in range(LINES)]  # states of equal tensions would be one line
    create(ours, replace(read_description(theirs), random=points))
    shutil.copy(theirs / "body.npz", ours)
    command = [sys.executable, "-m", "studies.training.claiming", str(ours), str(theirs)]
    jobs = [subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) for _ in range(processes)]
    time.sleep(2 + 0.6 * processes)  # all have started and wait
    begun = time.perf_counter()
    (ours / "go").touch()
    claims = sum(int(job.communicate()[0]) for job in jobs)
    seconds = time.perf_counter() - begun
    assert claims == LINES, "a line was written twice, or not at all"
    return {"processes": processes, "lines_per_second": claims / seconds}


def measure(run: Run) -> dict:
    """All of it."""
    return {
        "scaling": run.once("two ranks against one", scaling, run.folder),
        "contention": [run.once(f"claims of {n} processes", contention, run.folder, n) for n in PROCESSES],
        "long_run": run.once("a long run and its restart", long_run, run.folder),
    }
