"""A finger that air bends: trained on few states, it predicts others, and holds a force by pressure."""

import tomllib

import numpy as np
import pytest
from farm import ROOT, run

from control import Finger, Limits
from fingerfem import FingerModel
from fingerfem.full_order_plant import FullOrderPlant
from fingerfem.scene.scene import Scene
from rom.build import train_rod
from rom.dataset.snapshot_set import SnapshotSet
from rom.rod.objects.shapes import facing_plane
from rom.rod.pressed_check import check_pressed
from rom.rod.touched_segment import TouchedSegment
from studies.sets import as_toml

DISTANCES = (0.0005, 0.010)
pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def table():
    table = tomllib.loads((ROOT / "scenes" / "pressed_chambers.toml").read_text())
    return table | {"mesh": {"cells": [14, 7], "order": 1}, "sampling": {"lines": 32, "wrenches": 4}}


@pytest.fixture(scope="module")
def sets(table, tmp_path_factory):
    folder = tmp_path_factory.mktemp("chambers")
    (folder / "scene.toml").write_text(as_toml(table))
    run(2, folder / "scene.toml", folder / "training")
    run(2, folder / "scene.toml", folder / "heldout", "--random", "16")
    return folder


@pytest.fixture(scope="module")
def finger(sets):
    return train_rod(SnapshotSet(sets / "training"), {}, [], highest=4.0)


def test_held_out_states_are_predicted_with_the_work_of_pressure(sets, finger):
    found = check_pressed(finger, SnapshotSet(sets / "heldout"))
    assert found["states"] == 16 and found["failed"] == 0 and found["inside"] > 0.9
    assert found["place_m"]["p95"] < 1e-3 * 0.080 and found["contact_force"]["median"] < 1e-2
    assert found["contact_force"]["p95"] < 3e-2 and found["covered"] > 0.8
    assert found["chamber_growth_m3"]["p95"] < 0.02 * finger.growth([0.0, 4e4, 0.0])[0]


def test_the_force_that_pressure_holds_is_that_of_the_full_order_model(table, finger):
    """At the tip: contact with rubber over a chamber is marked, and the upper one stays empty."""
    before_plane = {name: one for name, one in table.items() if name != "load"} | {
        "obstacle": {"distance": [*DISTANCES]}
    }
    model = FingerModel(Scene.model_validate(before_plane))
    touched = TouchedSegment(rod=finger, obstacle=facing_plane(0.020, DISTANCES))
    controller = Finger(touched, Limits(upper=[15.0, 4e4, 0.0]))
    for force, distance in ((0.03, 0.005), (0.05, 0.004)):
        motion = controller.hold(force, distance)
        assert motion.converged and motion.tensions[1] > 1e4
        true = FullOrderPlant(model, distance).pull(motion.tensions)
        print(motion, true)
        assert true == pytest.approx(force, abs=max(2 * motion.error, 0.03 * force))


def test_answers_before_a_plane_are_right_or_marked(table, finger):
    """If both chambers bulge the faces, the plane is often touched there first."""
    before_plane = {name: one for name, one in table.items() if name != "load"} | {
        "obstacle": {"distance": [*DISTANCES]}
    }
    model, random = FingerModel(Scene.model_validate(before_plane)), np.random.default_rng(5)
    touched = TouchedSegment(rod=finger, obstacle=facing_plane(0.020, DISTANCES))
    marked = 0
    for _ in range(6):
        point = np.append(random.random(3) * [15.0, 4e4, 4e4], random.uniform(0.001, 0.004))
        state, answer = model.solve(point[:3], float(point[3]), sensitivities=False), touched.evaluate(point)
        marked += not answer.inside
        assert abs(answer.touch_distance - state.touch_distance) < answer.error["touch_distance"] + 2e-4
        if answer.inside:
            assert abs(answer.contact_force - (state.contact_force or 0.0)) < 0.02
    assert marked > 0
