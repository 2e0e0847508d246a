"""Training, measured: two ranks against one, what the farm costs, restart, memory, claims of 64 ranks at once.

python3 studies/training/training.py [OUT] [--quick]
    prints tables, writes OUT/training.json (out/farm by default); two cores
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from rom.snapshots.folder import create
from rom.snapshots.snapshot_set import read_description, read_task
from studies.solver.solver import say

LINES = 4000  # for the contention of claims
DRAFT = ROOT / "scenes" / "draft.toml"


def scene(folder: Path, tension_nodes: int, contact_nodes: int) -> Path:
    """The draft finger on another grid."""
    file = folder / f"draft-{tension_nodes}-{contact_nodes}.toml"
    text = DRAFT.read_text().split("[sampling]")[0]
    file.write_text(f"{text}\n[sampling]\ntension_nodes = {tension_nodes}\ncontact_nodes = {contact_nodes}\n")
    return file


def farm(ranks: int, file: Path, folder: Path, *options: str) -> dict:
    """Run the farm on a set until it is whole; what it reports, its wall time, and the resident memory of its ranks."""
    command = [sys.executable, "-m", "fingerfem", "snapshots", str(file), str(folder), "--json", *options]
    begun = time.perf_counter()
    job = subprocess.Popen(["mpirun", "-n", str(ranks), *command], cwd=ROOT, stdout=subprocess.PIPE, text=True)
    memory: list[dict[int, float]] = []
    while job.poll() is None:
        time.sleep(0.2)
        memory.append(resident(job.pid))
    if job.returncode:
        raise SystemExit(f"the farm ended with {job.returncode}")
    report = json.loads(job.stdout.read().splitlines()[-1])  # type: ignore[union-attr]
    return report | {"wall_seconds": time.perf_counter() - begun, "memory": memory}


def resident(job: int) -> dict[int, float]:
    """Resident memory of a job's ranks [MB]."""
    found: dict[int, float] = {}
    for pid in subprocess.run(["pgrep", "-P", str(job)], capture_output=True, text=True).stdout.split():
        try:
            lines = Path(f"/proc/{pid}/status").read_text().splitlines()
        except OSError:
            continue
        sizes = [int(line.split()[1]) / 1024 for line in lines if line.startswith("VmRSS")]
        found |= {int(pid): size for size in sizes}
    return found


def scaling(folder: Path, quick: bool) -> dict:
    """One rank and two on the same set, in turn, twice; the better of each counts."""
    file = scene(folder, *((4, 4) if quick else (9, 12)))
    rates: dict[int, list[float]] = {1: [], 2: []}
    for _ in range(1 if quick else 2):
        for ranks in rates:
            shutil.rmtree(folder / "set", ignore_errors=True)
            report = farm(ranks, file, folder / "set")
            # From the first claim to the last: a job's start is counted apart.
            rates[ranks].append(report["states"] / report["this_rank"]["seconds"])
            overhead = 1 - report["this_rank"]["solve_seconds"] / report["this_rank"]["seconds"]
            if ranks == 1:
                shares = overhead
    best = {ranks: max(found) for ranks, found in rates.items()}
    return {
        "states": report["states"],
        "states_per_second": best,
        "two_over_one": best[2] / best[1],
        "farm_overhead": shares,
        "start_seconds": report["wall_seconds"] - report["this_rank"]["seconds"],
        "bytes_per_state": report["bytes_per_state"],
        "newton_iterations_per_state": report["newton_iterations"] / report["states"],
    }


def long_run(folder: Path, quick: bool) -> dict:
    """Memory while thousands of states are solved, and the restart of the set once it is whole."""
    file = scene(folder, *((5, 5) if quick else (17, 17)))
    shutil.rmtree(folder / "long", ignore_errors=True)
    report = farm(2, file, folder / "long")
    memory = [max(sizes.values()) for sizes in report["memory"] if sizes]
    part = len(memory) // 4
    restart = min(farm(1, file, folder / "long")["wall_seconds"] for _ in range(3))
    return {
        "states": report["states"],
        "states_per_rank": report["states"] // 2,
        "memory_after_a_quarter": float(np.median(memory[part : part + max(part // 4, 1)])),
        "memory_at_the_end": float(np.median(memory[-max(part // 4, 2) : -1])),
        "restart_seconds": restart,
    }


CLAIMING = """
import sys, time
from pathlib import Path
from fingerfem.snapshots import Queue
from rom.snapshots import read_description, read_task
ours, theirs = map(Path, sys.argv[1:])
description = read_description(ours)
arrays = read_task(theirs, "contact-0-0")
spent, claims = 0.0, 0
while not (ours / "go").exists():
    time.sleep(0.01)
with Queue(description, ours, lambda task: True, lambda: None) as queue:
    while True:
        begun = time.perf_counter()
        if queue.claim() is None:
            break
        queue.finish(arrays)
        spent, claims = spent + time.perf_counter() - begun, claims + 1
print(claims, spent)
"""


def contention(folder: Path, processes: int) -> dict:
    """Processes that claim and write lines as fast as they can, the solving left out: the farm's own limit."""
    ours, theirs = folder / "claims", folder / "set"
    shutil.rmtree(ours, ignore_errors=True)
    point = [0.0] * len(read_description(theirs).parameters)
    description = replace(read_description(theirs), random=[point] * LINES)
    create(ours, description)
    shutil.copy(theirs / "body.npz", ours)
    command = [sys.executable, "-c", CLAIMING, str(ours), str(theirs)]
    jobs = [subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) for _ in range(processes)]
    time.sleep(2 + 0.6 * processes)  # all have started and wait
    begun = time.perf_counter()
    (ours / "go").touch()
    said = [job.communicate()[0].split() for job in jobs]
    seconds = time.perf_counter() - begun
    lines = sum(int(claims) for claims, _ in said)
    assert lines == len(description.tasks), "a line was written twice, or not at all"
    assert all(read_task(ours, task) for task in description.tasks)
    return {"processes": processes, "lines": lines, "seconds": seconds, "lines_per_second": lines / seconds}


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", nargs="?", default="out/farm")
    parser.add_argument("--quick", action="store_true", help="small grids")
    options = parser.parse_args()
    folder = Path(options.out).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    result: dict = {"cores": len(os.sched_getaffinity(0))}
    print("two ranks against one")
    result["scaling"] = scaling(folder, options.quick)
    say(result["scaling"])
    print("claims, without solving")
    result["contention"] = []
    for processes in (1, 8, 64):
        result["contention"].append(contention(folder, processes))
        say(result["contention"][-1])
    print("a long run and its restart")
    result["long_run"] = long_run(folder, options.quick)
    say(result["long_run"])
    (folder / "training.json").write_text(json.dumps(result, indent=1))


if __name__ == "__main__":
    main()
