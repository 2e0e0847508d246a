"""Rods of several materials against the full-order model: a stiff layer and a heavy core, with weight and taper."""

from typing import Any

import numpy as np
import pytest
from farm import run

from fingerfem import FingerModel
from fingerfem.scene.scene import Scene
from rom import Rod, TouchedSegment
from rom.build import train_rod
from rom.dataset.snapshot_set import SnapshotSet
from rom.rod.objects.shapes import facing_plane
from studies.sets import as_toml

FORCE, DEPTH = 0.3, 0.75  # trained [N]; of the way to the plane that touches [-]
TENSIONS = np.array([[2.3, 1.6], [0.9, 2.0], [1.4, 3.1]])  # [N]
HANGS = {"density": 1070.0, "direction": [-0.6, 0.8, 0.0]}
# Largest errors on the trained mesh: of the free tip over its displacement, and of contact forces. Measured: 0.030 and
# 0.38 %; with weight 0.14 and 0.88 %, as it acts at the ends of five elements. The core's is 1 % of the displacement.
ERRORS = [({}, 5e-4, 5e-3), ({"gravity": HANGS}, 2e-3, 1e-2)]
THINNER, OF_TAPER = 0.8, (1e-2, 3e-2)  # taper, and the same of a tapered finger, whose layer shears the soft rubber
STIFF = {"law": "neo-hookean", "C1": 5e6, "D1": 4e-8}  # 50 times the rubber
LAYER = {"name": "layer", "region": "rectangle", "centre": [-0.0045, 0.0], "size": [0.001, 0.010], "material": STIFF}
CORE = {"name": "core", "region": "rectangle", "centre": [0.0, 0.0], "size": [0.002, 0.002], "material": STIFF}
CORE |= {"density": 8000.0}
TABLE: dict[str, Any] = {
    "name": "finger",
    "geometry": {"side": 0.010, "segments": [0.045], "plate": 0.001},
    "material": {"law": "neo-hookean", "C1": 1e5, "D1": 2e-6},
    "tendons": [
        {"name": "F1", "offset": [0.003, 0.0], "segment": 1, "tension": [0.0, 4.0]},
        {"name": "F2", "offset": [0.0, 0.003], "segment": 1, "tension": [0.0, 4.0]},
    ],
    "materials": [LAYER, CORE],
    "mesh": {"cells": [12, 7]},
}


def test_tip_and_force_are_those_of_the_full_order_model(tmp_path):
    sampling = {"lines": 16, "wrenches": 3}
    (tmp_path / "scene.toml").write_text(as_toml(TABLE | {"load": {"force": FORCE}, "sampling": sampling}))
    run(2, tmp_path / "scene.toml", tmp_path / "set")
    trained = train_rod(SnapshotSet(tmp_path / "set"), {}, [])
    for more, of_tip, of_force in ERRORS:
        compare(trained, TABLE | more, TENSIONS, of_tip, of_force)
    tendons = [one | {"tension": [0.0, 4.0 * THINNER**2]} for one in TABLE["tendons"]]
    # cells as long over their sections as the trained ones: 12 over the same number of sides, one of them the plate's
    length = 0.044 * (1 - THINNER) / -np.log(THINNER) + 0.001 * THINNER
    geometry = TABLE["geometry"] | {"segments": [float(length)], "taper": [THINNER]}
    compare(trained, TABLE | {"geometry": geometry, "tendons": tendons}, TENSIONS[:1] * THINNER**2, *OF_TAPER)


def compare(trained: Rod, table: dict[str, Any], tensions: np.ndarray, of_tip: float, of_force: float) -> None:
    """Free and before a plane, at tensions [N]; the largest errors of the tip and of the force [-]."""
    rod = trained.assembled(table)
    model = TouchedSegment(rod=rod, obstacle=facing_plane(0.01, (0.0, 0.03)))
    full = FingerModel(Scene.model_validate(table | {"obstacle": {"distance": [0.0005, 0.03]}}))
    for pulled in tensions:
        free = model.evaluate([*pulled, np.inf])
        distance = DEPTH * float(free.touch_distance)
        pressed = model.evaluate([*pulled, distance])
        tip = full.solve(pulled, sensitivities=False).tip
        force = full.solve(pulled, distance, sensitivities=False).contact_force
        assert free.inside and pressed.inside and force > 0.05
        off = float(np.linalg.norm(free.tip - tip))
        assert off < of_tip * np.linalg.norm(tip) and off < free.error["tip"]
        assert float(pressed.contact_force) == pytest.approx(force, rel=of_force)
