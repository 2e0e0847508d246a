"""A rod of two segments with chambers, of elements of one, beside the full-order model."""

from typing import Any

import numpy as np
import pytest
from farm import run

from fingerfem import FingerModel
from fingerfem.scene.scene import Scene
from rom import TouchedSegment
from rom.build import train_rod
from rom.dataset.snapshot_set import SnapshotSet
from rom.rod.objects.shapes import facing_plane
from studies.sets import as_toml

LENGTH, SPAN = 0.060, (0.002, 0.056)  # of a segment, and where its chambers begin and end [m]
LOADS = np.array(
    [[1.0, 20e3, 0.0, 15e3, 0.0]]
)  # tension [N] and pressures [Pa]; the upper face touches, and must not bulge
DEPTH = 0.8  # of the way to the plane that touches [-]
TABLE: dict[str, Any] = {
    "name": "finger",
    "geometry": {"side": 0.020, "segments": [LENGTH], "plate": 0.002, "channel": 0.003},
    "material": {"law": "neo-hookean", "C1": 115e3, "D1": 4e-6},
    "tendons": [{"name": "F1", "offset": [0.0, 0.0], "segment": 1, "tension": [0.0, 6.0]}],
    "mesh": {"cells": [12, 9]},
}


def chambers(segment: int) -> list[dict[str, Any]]:
    """The two chambers of a segment, counted from 0."""
    x = [segment * LENGTH + end for end in SPAN]
    one = {"region": "rectangle", "size": [0.006, 0.012], "x": x, "pressure": [0.0, 30e3]}
    return [one | {"name": f"p{2 * segment + k}", "centre": [y, 0.0]} for k, y in ((1, -0.0045), (2, 0.0045))]


@pytest.mark.long
def test_tip_and_force_are_those_of_the_full_order_model(tmp_path):
    """Within 0.3 and 2 %, free and before a plane, with growths of the volumes within 0.5 % of the largest."""
    one = TABLE | {"chambers": chambers(0)}
    load = {"force": 0.3, "moment": 0.02, "reach": LENGTH}
    (tmp_path / "scene.toml").write_text(as_toml(one | {"load": load, "sampling": {"lines": 20, "wrenches": 3}}))
    run(2, tmp_path / "scene.toml", tmp_path / "set")
    geometry = TABLE["geometry"] | {"segments": [LENGTH, LENGTH]}
    tendons = [TABLE["tendons"][0] | {"segment": 2}]
    two = TABLE | {"geometry": geometry, "tendons": tendons, "chambers": chambers(0) + chambers(1)}
    rod = train_rod(SnapshotSet(tmp_path / "set"), {}, []).assembled(two)
    model = TouchedSegment(rod=rod, obstacle=facing_plane(0.020, (0.0, 0.06)))
    full = FingerModel(Scene.model_validate(two | {"obstacle": {"distance": [0.0005, 0.06]}}))
    empty = np.prod([0.006, 0.012]) * (SPAN[1] - SPAN[0])
    for loads in LOADS:
        free, state = model.evaluate([*loads, np.inf]), full.solve(loads, sensitivities=False)
        assert free.inside and np.linalg.norm(free.tip - state.tip) < 3e-3 * np.linalg.norm(state.tip)
        grown = np.array(list(state.chamber_volumes.values())) - empty
        assert free.growths == pytest.approx(grown, abs=5e-3 * np.abs(grown).max())
        distance = DEPTH * float(free.touch_distance)
        pressed = model.evaluate([*loads, distance])
        force = full.solve(loads, distance, sensitivities=False).contact_force
        assert pressed.inside and float(pressed.contact_force) == pytest.approx(force, rel=2e-2)
