"""Friction of tendons calibrated on logs of full-order histories with noise: its error, and what intervals cover."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from control import CalibrationOptions, calibrate
from control.log import write_log
from rom import Rod
from rom.error_statistics import quantiles
from studies.cores import on_cores
from studies.guides.histories import FRICTION, PULLED, before_plane, full_model
from studies.parts import Run
from studies.rods import plans

HISTORIES, POSES, INCREMENTS = 5, 30, 2  # of different friction; points of each, and increments between two
DRAWS, SEED = 4, 44  # of noise by history: the logs
NOISE = {"tension": 0.02, "shortening": 1e-4, "position": 5e-4}  # standard deviations [-, m, m]
CLOSE = 0.02  # error that is asked for [-]


def history(table: dict[str, Any], k: int) -> dict[str, Any] | None:
    """Tensions [N], shortenings and positions of the tip [m] along a full-order history; None if it fails."""
    from fingerfem import LoadNotReached
    from fingerfem.guide_history import guide_history

    random, friction = np.random.default_rng((SEED, k)), float(np.linspace(*FRICTION, HISTORIES)[k])
    points = np.column_stack([random.uniform(*ends, POSES) for ends in PULLED])
    try:
        states = guide_history(full_model(table, False), points, friction, increments=INCREMENTS)
    except LoadNotReached:
        return None
    measured = {
        "shortening": [one.shortenings.tolist() for one in states],
        "position": [one.tip.tolist() for one in states],
    }
    return {"friction": friction, "tension": points.tolist(), **measured}


def calibrated(folder: Path, rod: Rod, truth: dict[str, Any], seed: int) -> dict[str, Any]:
    """One log of a history, and what its calibration returns."""
    random = np.random.default_rng((SEED, HISTORIES, seed))
    own = {name: np.array(truth[name]) for name in NOISE}
    own["tension"] *= 1 + NOISE["tension"] * random.standard_normal(own["tension"].shape)
    for name in ("shortening", "position"):
        own[name] += NOISE[name] * random.standard_normal(own[name].shape)
    columns = {f"{name} [N]": own["tension"][:, k] for k, name in enumerate(rod.names)}
    columns |= {f"{name} [m]": own["shortening"][:, k] for k, name in enumerate(rod.names)}
    columns |= {f"{axis} [m]": own["position"][:, k] + rod.rest[k] for k, axis in enumerate("xyz")}
    file = write_log(folder / f"friction-{seed}.csv", columns)
    found = calibrate(before_plane(rod), file, CalibrationOptions(fit=("modulus", "base", "friction")))
    (fitted,) = (one for one in found.parameters if one.name == "friction")
    lower, upper = fitted.interval or (np.nan, np.nan)
    return {
        "error": fitted.value - truth["friction"],
        "half": (upper - lower) / 2,
        "covered": bool(lower <= truth["friction"] <= upper),
        "modulus": found.value("modulus") / found.parameters[0].start - 1,
    }


def measure(run: Run) -> dict[str, Any]:
    """Errors of friction and modulus in all logs."""
    rod, table = plans.rod(run, plans.LARGE), tomllib.loads(plans.scene(run, plans.LARGE).read_text())
    truths = run.once("histories", lambda: on_cores(history, [(table, k) for k in range(HISTORIES)]))
    given = [one for one in truths if one is not None]
    calls = [(run.folder, rod, one, DRAWS * k + draw) for k, one in enumerate(given) for draw in range(DRAWS)]
    logs = on_cores(calibrated, calls)
    errors = np.abs([one["error"] for one in logs])
    return {
        "histories": HISTORIES,
        "solved": len(given),
        "logs": len(logs),
        "poses": POSES,
        "friction": quantiles(errors),
        "close": float(np.mean(errors <= CLOSE)),
        "half": float(np.median([one["half"] for one in logs])),
        "covered": float(np.mean([one["covered"] for one in logs])),
        "modulus": quantiles(np.abs([one["modulus"] for one in logs])),
    }
