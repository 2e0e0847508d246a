"""Friction of tendons in the channels of the full-order model: the law, its history, and its work."""

import numpy as np
import pytest
from farm import ROOT

from fingerfem import FingerModel
from fingerfem.guide_history import guide_history
from fingerfem.scene.scene import Scene

FRICTION = 0.2


@pytest.fixture(scope="module")
def finger() -> FingerModel:
    """The draft finger alone, on few cells."""
    import tomllib

    table = tomllib.loads((ROOT / "scenes" / "draft.toml").read_text())
    del table["obstacle"], table["sampling"]
    return FingerModel(Scene.model_validate(table | {"mesh": {"cells": [10, 5], "order": 1}}))


def test_without_friction_it_is_the_frictionless_state(finger):
    pulled = [50.0, 20.0]
    (state,) = guide_history(finger, [pulled], 0.0, increments=2)
    expected = finger.solve(pulled, sensitivities=False)
    np.testing.assert_allclose(state.tip, expected.tip, atol=1e-9)
    assert state.dissipated == pytest.approx(0.0, abs=1e-12)


def test_a_pulled_tendon_loses_exp_of_friction_times_its_turn_and_a_release_begins_at_the_motor(finger):
    pulled, released, low = guide_history(finger, [[60.0, 0.0], [57.0, 0.0], [10.0, 0.0]], FRICTION, increments=1)
    turned = pulled.turned[0]
    assert turned[-1] > 0.8
    np.testing.assert_allclose(pulled.layer_tensions[0], 60.0 * np.exp(-FRICTION * turned), rtol=1e-6)
    assert released.layer_tensions[0][0] < pulled.layer_tensions[0][0] - 0.5
    assert released.layer_tensions[0][-1] == pytest.approx(pulled.layer_tensions[0][-1], rel=1e-6)  # it sticks there
    assert (np.diff(low.layer_tensions[0]) > 0).all()


def test_a_constant_per_length_adds_up_along_the_finger(finger):
    (state,) = guide_history(finger, [[30.0, 0.0]], 0.0, per_length=20.0, increments=1)
    assert state.layer_tensions[0][0] - state.layer_tensions[0][-1] == pytest.approx(20.0 * 0.049 * 8 / 9, rel=1e-6)


def test_the_motor_s_work_is_what_is_stored_and_what_friction_took(finger):
    """To the error of the trapezoidal rule over the increments."""
    defects = []
    for increments in (2, 4):
        first, _, last = guide_history(finger, [[20.0, 0.0], [60.0, 0.0], [20.0, 0.0]], FRICTION, increments=increments)
        lost, took = last.work - first.work, last.dissipated - first.dissipated
        defects.append(abs(lost - took - (last.energy - first.energy)))
    assert took > 0.01 and defects[1] < 0.07 * took and defects[1] < 0.4 * defects[0]


def test_wrong_histories_are_refused_in_one_line(finger):
    with pytest.raises(ValueError, match="points must be finite"):
        guide_history(finger, [[1.0]], FRICTION)
    with pytest.raises(ValueError, match="friction and per_length must be finite and at least 0"):
        guide_history(finger, [[1.0, 0.0]], -0.1)
    with pytest.raises(ValueError, match=r"F1 must lie in \[0, 100\] N"):
        guide_history(finger, [[1e3, 0.0]], FRICTION)
