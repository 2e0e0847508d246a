"""Grids of other scenes: one tendon that touches at its lowest tension, and no obstacle at all."""

from pathlib import Path

import pytest
from farm import ROOT, run

from fingerfem import FingerModel, load_scene
from rom.dataset.snapshot_set import SnapshotSet

DRAFT = (ROOT / "scenes" / "draft.toml").read_text().replace("[20, 5]", "[10, 5]")
SECOND_TENDON = DRAFT[DRAFT.rindex("[[tendons]]") : DRAFT.index("[obstacle]")]
OBSTACLE = DRAFT[DRAFT.index("[obstacle]") : DRAFT.index("[mesh]")]


def solved(folder: Path, text: str) -> tuple[SnapshotSet, FingerModel]:
    file = folder / "scene.toml"
    file.write_text(text)
    assert run(2, file, folder / "set")["failed"] == 0
    return SnapshotSet(folder / "set"), FingerModel(load_scene(file))


@pytest.mark.long
def test_a_finger_that_touches_at_its_lowest_tension_is_in_contact_from_there_on(tmp_path):
    text = DRAFT.replace(SECOND_TENDON, "").replace("tension = [0.0, 100.0]", "tension = [20.0, 60.0]")
    snapshots, model = solved(tmp_path, text)
    force, points = snapshots.contact("contact_force"), snapshots.contact("parameters")
    assert force.shape == (4, 4) and (force > 0).all()
    assert points[:, -1, 1] == pytest.approx(0.001)
    for k in range(4):
        state = model.solve(points[k, -1, :1], 0.001, sensitivities=False)
        assert force[k, -1] == pytest.approx(state.contact_force, abs=1e-4)


def test_without_an_obstacle_a_grid_has_free_states_alone(tmp_path):
    snapshots, model = solved(tmp_path, DRAFT.replace(OBSTACLE, ""))
    assert list(snapshots.description.lines) == [f"free-{k}" for k in range(4)] and snapshots.states == 16
    assert snapshots.answered("tip").shape == (16, 3)
    points, tips = snapshots.free("parameters"), snapshots.free("tip")
    assert tips[2, 1] == pytest.approx(model.solve(points[2, 1], sensitivities=False).tip, abs=1e-8)
