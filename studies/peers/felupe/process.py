"""FElupe's process: reads a finger and what is asked of it, solves it by FElupe, writes the answers.

PYTHONPATH=.:out/peers/felupe python3 -m studies.peers.felupe.process FILE_IN FILE_OUT

FElupe is under the GPL and no part of this project: it is imported here and nowhere else, in a process of its own,
whose only link with the rest are two files. FILE_IN (comparison.py writes it) holds the finger and no answer: the
arrays and the scene that `Finger` takes, and `states`, each {"tensions": [N], "distance": [m] or null}. FILE_OUT has
the displacements, in the order of the given nodes, and a report of each.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import felupe
import numpy as np

from studies.peers.felupe.finger import Finger, Tolerance
from studies.peers.felupe.steps import Equilibrium, Load, NotReached, adaptively

# Round-off of steel keeps the residual at some 1e-12; Newton's method converges quadratically, so what an iteration
# that moves no node by a billionth of the length leaves is far below round-off.
TIGHT = Tolerance(residual=0.0, noise=1e-8, settled=1e-9)


def states(finger: Finger, asked: list[dict[str, Any]]) -> tuple[np.ndarray, list[dict[str, Any]]]:
    """Each state from rest: by its tensions; then the plane comes from where it touches.

    What is known of the free finger at the same tensions is not solved again.

    Returns:
        displacements, shape (states, nodes, 3) [m]; a dict for every state.
    """
    displacements, reports = [], []
    free: dict[tuple[float, ...], Equilibrium] = {}
    for state in asked:
        before, tensions, distance = finger.factorisations, np.array(state["tensions"], float), state["distance"]
        report: dict[str, Any] = {"reach": None, "contact_force": None, "failed": None}
        found = Equilibrium(finger.rest, Load(0 * tensions, None))
        try:
            key = tuple(tensions.tolist())
            free[key] = free.get(key) or adaptively(finger, found, Load(tensions, None))
            found = free[key]
            report["reach"] = finger.reach(found.displacement)
            if distance is not None:
                if distance < report["reach"]:
                    touching = Equilibrium(found.displacement, Load(tensions, report["reach"]))
                    found = adaptively(finger, touching, Load(tensions, distance))
                report["contact_force"] = finger.contact_force(found.displacement, distance)
        except NotReached as failure:
            report["failed"] = str(failure)
        report["iterations"] = finger.factorisations - before
        displacements.append(found.displacement)
        reports.append(report)
    return np.array(displacements), reports


def answer(given: Path, wanted: Path) -> None:
    """Read a task, do it, write what it found."""
    with np.load(given) as file:
        arrays = {name: file[name] for name in file.files}
    settings = json.loads(str(arrays.pop("settings")))
    # A step that diverges overflows before FElupe sees it.
    with np.errstate(all="ignore"):
        displacements, reports = states(Finger(arrays, settings["scene"], TIGHT), settings["states"])
    report = {"felupe": felupe.__version__, "found": reports}
    np.savez(wanted, displacements=displacements, report=np.array(json.dumps(report)))


if __name__ == "__main__":
    answer(Path(sys.argv[1]), Path(sys.argv[2]))
