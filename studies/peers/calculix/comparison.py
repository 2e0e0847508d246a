"""CalculiX beside this project: the bar of the part `bar` on the same mesh, and what an iteration takes.

The environment's Debian has no CalculiX, so the machine's own does it (Debian 12 and Ubuntu: calculix-ccx), with the
Python that make docs has for what others need.
"""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np

from studies.peers.calculix.files import PROGRAM, TIGHT, Deck, Solved, solve, version
from studies.peers.calculix.motions import STEPS, block, motions
from studies.peers.question import finger
from studies.runner import Run, say

PAPER, SHORT = (100, 10, 10), (20, 5, 5)  # cells that an iteration is timed on, the latter in the short form
FEW, MORE, TIMED = 1, 3, 24  # steps of the motion that are timed, of so many: what is done once does not count
DIGITS = 7  # of numbers in CalculiX's text


def compared(stored: Any, name: str, folder: Path) -> dict[str, Any]:
    """One motion of the bar, and how far CalculiX's answer is from the forms' at most.

    `force` is over the largest nodal force, `last_digit` over the unit of each number's last printed digit: up to a
    half is the rounding of the text.
    """
    nodes, motion = stored["nodes"], motions(stored["nodes"])[name]
    deck = Deck(nodes=nodes, cells=stored["cells"], finger=finger(), motion=motion, steps=STEPS, controls=TIGHT,
                prints=True)  # fmt: skip
    solved = solve(deck, folder / name.replace(" ", "_"))
    held, forces = solved.forces()
    ours, moved = stored[f"{name}: forces"][held], stored[f"{name}: displacement"]
    # Of the components that are held: the others' forces are round-off here, and nothing to be compared there.
    pulls = motion.held[held]
    off = np.abs(forces - ours)[pulls]
    unit = 10.0 ** (np.floor(np.log10(np.maximum(np.abs(forces[pulls]), 1e-300))) - DIGITS + 1)
    largest = float(np.abs(ours).max())
    return {
        "motion": name,
        "iterations": solved.iterations,
        "displacement": float(np.abs(solved.displacements() - moved).max()),
        "largest_displacement": float(np.abs(moved).max()),
        "force": float(off.max()) / largest,
        "largest_force": largest,
        "last_digit": float((off / unit)[np.abs(ours[pulls]) > 1e-6 * largest].max()),
    }


def seconds_per_iteration(counts: tuple[int, int, int], folder: Path) -> dict[str, Any]:
    """Of the bar that is bent on a finer mesh: what more steps take more, over the iterations they take more."""
    nodes, cells = block(counts)
    motion = motions(nodes)["bending"]
    runs: list[Solved] = []
    for steps in (FEW, MORE):
        part = motion.begun(steps / TIMED)
        deck = Deck(nodes=nodes, cells=cells, finger=finger(), motion=part, steps=steps)
        runs.append(solve(deck, folder / f"speed{steps}"))
    few, more = runs
    return {
        "cells": list(counts),
        "unknowns": 3 * len(nodes),
        "iterations": more.iterations,
        "seconds": more.seconds,
        "seconds_per_iteration": (more.seconds - few.seconds) / (more.iterations - few.iterations),
    }


def measure(run: Run) -> dict[str, Any]:
    """All of it.

    Raises:
        SystemExit: there is no CalculiX, or `bar` has not been measured.
    """
    if shutil.which(PROGRAM) is None:
        raise SystemExit(f"peers/calculix: {PROGRAM} must be installed (Debian, Ubuntu: calculix-ccx), got nothing")
    if not (run.folder / "bar.npz").exists():
        raise SystemExit("peers/calculix: peers/bar must be measured first: python3 -m studies.runner peers")
    folder = run.folder / "calculix"
    with np.load(run.folder / "bar.npz") as stored:
        rows = [compared(stored, name, folder) for name in motions(stored["nodes"])]
    for row in rows:
        say(row)
    speed = seconds_per_iteration(SHORT if run.quick else PAPER, folder)
    say(speed)
    return {"version": version(), "linear_solver": "SPOOLES", "bar": rows, "speed": speed}
