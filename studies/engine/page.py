"""The table of MuJoCo's forces."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from rom.error_statistics import quantiles

WITHIN = 0.03  # [-]


def prepare(found: dict, folder: Path) -> dict:
    """Errors by place and shape, and counts within WITHIN."""
    pairs = [
        row | {"full_order": true} for row, true in zip(found["moments"], found["full_order"], strict=True) if true
    ]
    kinds = {f"{one['shape']}, {one['place']}": (one["place"], one["shape"]) for one in found["moments"]}
    rows = []
    for name, kind in (kinds | {"all": None}).items():
        own = [one for one in pairs if kind is None or (one["place"], one["shape"]) == kind]
        errors = {key: np.array([abs(one[key] / one["full_order"] - 1) for one in own]) for key in ("mujoco", "rod")}
        within = {key: int((one <= WITHIN).sum()) for key, one in errors.items()}
        apart = max(abs(one["mujoco"] / one["rod"] - 1) for one in own)
        own_quantiles = {key: quantiles(one) for key, one in errors.items()}
        rows.append({"name": name, "count": len(own), "errors": own_quantiles, "within": within, "apart": apart})
    forces = [one["full_order"] for one in pairs]
    failed = sum(one is None for one in found["full_order"])
    return {"rows": rows, "within": WITHIN, "forces": [min(forces), max(forces)], "failed": failed}
