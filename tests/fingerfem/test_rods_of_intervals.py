"""A rod of a stiffer material along a part of its axis beside the full-order model."""

from typing import Any

import numpy as np
import pytest
from farm import run
from test_rods_of_materials import compare

from rom.build import train_rod
from rom.dataset.snapshot_set import SnapshotSet
from studies.sets import as_toml

CELL = 0.0025  # of the trained mesh, which has sections at one side from the clamp [m]
TENSIONS = np.array([[2.3, 0.4], [3.2, 1.0], [2.8, 2.0]])  # [N]
TABLE: dict[str, Any] = {
    "name": "finger",
    "geometry": {"side": 0.010, "segments": [0.046], "plate": 0.001},
    "material": {"law": "neo-hookean", "C1": 1e5, "D1": 2e-6},
    "tendons": [
        {"name": "F1", "offset": [0.004, 0.0], "segment": 1, "tension": [0.0, 4.0]},
        {"name": "F2", "offset": [0.0, 0.004], "segment": 1, "tension": [0.0, 4.0]},
    ],
    "mesh": {"cells": [19, 5]},
}


@pytest.mark.long
def test_tip_and_force_are_those_of_the_full_order_model(tmp_path):
    """Within 0.5 and 2 %, where the stiffer material begins in the middle, or at the clamp. Poisson's ratio is 0.41."""
    sampling = {"lines": 20, "wrenches": 4}
    (tmp_path / "scene.toml").write_text(as_toml(TABLE | {"load": {"force": 0.3}, "sampling": sampling}))
    run(2, tmp_path / "scene.toml", tmp_path / "set")
    trained = train_rod(SnapshotSet(tmp_path / "set"), {}, [])
    for ratio, begin, end in ((3.0, 7, 11), (20.0, 7, 11), (4.0, 0, 7)):
        law = {"law": "neo-hookean", "C1": ratio * 1e5, "D1": 2e-6 / ratio}
        part = {"name": "stiff", "region": "section", "x": [begin * CELL, end * CELL], "material": law}
        compare(trained, TABLE | {"materials": [part]}, TENSIONS, 5e-3, 2e-2)
