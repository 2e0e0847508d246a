"""Natural frequencies of rods against the full-order model, about free states and states in contact with a plane."""

from __future__ import annotations

from typing import Any

import numpy as np

from rom import MovingFinger
from rom.error_statistics import quantiles
from rom.files.checked_file import ModelError
from studies.motion.fingers import DENSITY, DISTANCES, NAMES, table, touching, trained
from studies.parts import Run

STATES, SEED = 26, 44  # of every finger, free and in contact in turns
SHARE = 0.5  # largest tensions over the trained ones [-]
DEPTHS = 0.3, 0.95  # d over the distance of touch [-]
MODES = 3
KINDS = "free", "plates", "rubber"  # no contact; contact of plates alone; contact of rubber in the rod


def states(run: Run, name: str) -> dict[str, Any]:
    """Random states of a finger: relative errors of its first frequencies by kind, and how many were left out."""
    from fingerfem.dynamics.modes import ModalAnalysis
    from fingerfem.equilibrium.failures import LoadNotReached
    from fingerfem.scene.scene import Scene

    rod, random = trained(run, name), np.random.default_rng(SEED)
    full, model = ModalAnalysis(Scene.model_validate(table(rod, before_plane=True))), touching(rod)
    upper = SHARE * np.array([one.upper for one in rod.parameters])
    finger = MovingFinger(model, np.append(0 * upper, np.inf), DENSITY)
    errors: dict[str, list[list[float]]] = {kind: [] for kind in KINDS}
    left = {"beyond": 0, "failed": 0}
    for k in range(STATES):
        tensions, d = upper * random.random(len(upper)), np.inf
        while k % 2 and not DISTANCES[0] <= d <= DISTANCES[1]:
            tensions = upper * random.random(len(upper))
            d = random.uniform(*DEPTHS) * float(model.evaluate([*tensions, np.inf]).touch_distance)
        contacts = model.contact_forces([*tensions, d]) if k % 2 else []
        try:
            ours = finger.frequencies([*tensions, d], MODES)
            theirs = full.solve(tensions, d if k % 2 else None, count=MODES).frequencies
        except ModelError:
            left["beyond"] += 1
            continue
        except LoadNotReached:
            left["failed"] += 1
            continue
        kind = KINDS[(1 + any(one.rubber for one in contacts)) * (k % 2)]
        errors[kind].append(np.abs(ours / theirs - 1).tolist())
    return {"errors": errors, "left": left}


def measure(run: Run) -> dict[str, Any]:
    """Errors of every finger, and over all fingers by kind."""
    rows = {name: run.once(name, states, run, name) for name in NAMES}
    found = {
        name: {kind: [quantiles(own) for own in np.array(one).T] for kind, one in row["errors"].items() if one}
        for name, row in rows.items()
    }
    left = {name: sum(row["left"][name] for row in rows.values()) for name in ("beyond", "failed")}
    return {"fingers": found, "left": left, "states": STATES * len(NAMES)}
