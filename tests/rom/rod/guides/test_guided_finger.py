"""Friction of tendons in their guides: the law, its history, its work, and what a finger without it answers."""

from itertools import pairwise

import numpy as np
import pytest
from assembled import in_series

from rom import GuidedFinger, Rod, guide_history
from rom.files.checked_file import ModelError
from rom.rod.compiled import reports

FRICTION = 0.2


def bends(finger: GuidedFinger) -> np.ndarray:
    """Angles between the normals of the sections that bound each element, from the plate to the clamp [rad]."""
    chain, arrays = finger.touching.chain, finger.arrays
    ((_, rotations, _),) = reports.elements(chain, arrays.motors, np.zeros((1, 6)))
    normals = np.concatenate([rotations[:, :, 0], [[1.0, 0.0, 0.0]]])
    return np.arccos(np.clip(np.sum(normals[1:] * normals[:-1], axis=1), -1, 1))


@pytest.mark.parametrize("tensions", [(20.0, 0.0), (80.0, 0.0), (0.0, 50.0), (60.0, 40.0)])
def test_a_pulled_tendon_loses_exp_of_friction_times_its_turn(model, tensions):
    finger = GuidedFinger(model=model.rod, friction=FRICTION)
    state = finger.advance(tensions)
    bent = bends(finger)
    turned = np.cumsum(bent[::-1])[::-1] - bent / 2  # from the clamp to the middle of each element
    expected = np.exp(-FRICTION * turned)[:, None] * tensions
    assert state.status == "converged" and turned[0] > 0.2
    assert state.element_tensions == pytest.approx(expected, rel=1e-6, abs=1e-9)


def test_a_constant_per_length_adds_up_along_a_straight_finger(model):
    finger = GuidedFinger(model=model.rod, friction=0.0, per_length=20.0)
    found = finger.advance([30.0, 0.0]).element_tensions[:, 0]
    lengths = np.array([one.length for one in model.rod.pieces[0]])
    lengths[0] -= model.rod.half_lengths[0]
    assert found == pytest.approx(30.0 - 20.0 * (np.cumsum(lengths[::-1])[::-1] - lengths / 2), rel=1e-9)


def test_a_release_first_slips_at_the_motor_and_sticks_at_the_tip(model):
    pulled, released, low = guide_history(model.rod, [[60.0, 0.0], [54.0, 0.0], [10.0, 0.0]], FRICTION, increments=1)
    assert released.element_tensions[0] == pytest.approx(pulled.element_tensions[0], rel=1e-9)
    assert released.element_tensions[-1, 0] < pulled.element_tensions[-1, 0]
    assert (np.diff(low.element_tensions[:, 0]) < 0).all()  # the largest at the tip
    assert (np.diff(pulled.element_tensions[:, 0]) > 0).all()


def test_what_friction_took_is_the_work_lost_in_a_closed_loop(model):
    finger, count = GuidedFinger(model=model.rod, friction=FRICTION), 600
    for _ in range(2):
        begun = finger.advance([20.0, 0.0])
        for share in np.concatenate([np.arange(1, count + 1), np.arange(count - 1, -1, -1)]) / count:
            state = finger.advance([20.0 + 60.0 * share, 0.0])
    assert state.shortenings == pytest.approx(begun.shortenings, abs=1e-12)
    lost, took = state.work - begun.work, state.dissipated - begun.dissipated
    assert took > 0.05 and lost == pytest.approx(took, rel=1e-6)


def test_a_loop_of_both_motors_leaves_what_separately_trained_shortenings_do(model):
    lower, upper, count = np.array([20.0, 10.0]), np.array([80.0, 60.0]), 50
    corners = np.array([lower, [upper[0], lower[1]], upper, [lower[0], upper[1]], lower])
    finger = GuidedFinger(model=model.rod, friction=0.0)
    finger.advance(lower)
    begun = finger.work
    for first, second in pairwise(corners):
        for share in np.arange(1, count + 1) / count:
            state = finger.advance(first + share * (second - first))
    # Green's theorem: the closed integral of F . dS is that of dS_1/dF_2 - dS_2/dF_1 over the area
    nodes, weights = np.polynomial.legendre.leggauss(8)
    sides = lower + (upper - lower) * (1 + nodes[:, None]) / 2
    grid = np.array([[one, other, np.inf] for one in sides[:, 0] for other in sides[:, 1]])
    rates = model.report(grid).shortening_jacobian
    area = np.outer(weights, weights).ravel() / 4 * (upper - lower).prod()
    expected = float(area @ (rates[:, 0, 1] - rates[:, 1, 0]))
    assert state.work - begun == pytest.approx(expected, rel=0.01)
    assert abs(expected) < 1e-4 * float(area @ rates[:, 0, 0])  # both are symmetric in the full-order model


def test_friction_takes_work_in_every_increment_of_any_history(model):
    random, finger = np.random.default_rng(3), GuidedFinger(model=model.rod, friction=0.3, per_length=5.0)
    taken = [0.0]
    for _ in range(100):
        state = finger.advance(random.uniform(0.0, 60.0, 2))
        assert state.status == "converged"
        taken.append(state.dissipated)
    assert (np.diff(taken) >= -1e-12).all() and taken[-1] > 0.1


def test_without_friction_the_answers_are_those_of_evaluate(model):
    random, compared = np.random.default_rng(0), 0
    finger = GuidedFinger(model=model, friction=0.0)
    for _ in range(60):
        point = np.append(random.uniform(0.0, 90.0, 2), random.uniform(0.0, 0.04))
        expected = model.evaluate(point)
        if not expected.inside:
            continue
        finger.rest()
        found, compared = finger.advance(point), compared + 1
        assert found.tip == pytest.approx(expected.tip, abs=1e-9)
        assert found.contact_forces == pytest.approx([expected.contact_force], abs=1e-9)
        assert found.shortenings == pytest.approx(expected.shortenings, abs=1e-9)
        assert found.dissipated == pytest.approx(0.0, abs=1e-12)
    assert compared > 30


@pytest.mark.parametrize("d", [0.05, 0.01])
@pytest.mark.parametrize("pulled", [(70.0, 30.0), (50.0, 25.0), (60.0, 50.0)])
def test_derivatives_are_differences_while_moves_stay(model, pulled, d):
    def after(at: np.ndarray) -> tuple[GuidedFinger, np.ndarray]:
        finger = GuidedFinger(model=model, friction=FRICTION)
        finger.advance([60.0, 30.0, d])
        state = finger.advance(at)
        return finger, np.append(state.tip, state.contact_forces)

    point, step = np.append(pulled, d), 0.02
    before = after(point)[0].arrays.keep()
    finger = after(point)[0]
    found = finger.jacobian()
    assert all(np.array_equal(one, other) for one, other in zip(finger.arrays.keep(), before, strict=True))
    for column in np.flatnonzero(point[:2] != [60.0, 30.0]):  # at a reversal there are two
        ahead = step * np.eye(3)[column]
        difference = (after(point + ahead)[1] - after(point - ahead)[1]) / (2 * step)
        scale = np.abs(difference).max()
        assert found[:, column] == pytest.approx(difference, abs=(1e-5 if d > 0.02 else 2e-3) * scale)


def test_motors_driven_by_position_find_the_tensions_that_make_these_shortenings(model):
    pulled = [[60.0, 20.0, 0.012], [30.0, 20.0, 0.012], [50.0, 20.0, 0.012]]
    by_tension = guide_history(model, pulled, FRICTION, increments=3)
    points = [[*one.shortenings, point[2]] for one, point in zip(by_tension, pulled, strict=True)]
    finger = GuidedFinger(model=model, friction=FRICTION)
    for state, point in zip(by_tension, points, strict=True):
        found = finger.advance(point, wound=("F1", "F2"))
        assert found.shortenings == pytest.approx(state.shortenings, abs=1e-9)
    alone = GuidedFinger(model=model.rod, friction=FRICTION)
    reached = alone.advance([60.0, 0.0])
    other = GuidedFinger(model=model.rod, friction=FRICTION)
    wound = other.advance([reached.shortenings[0], 0.0], wound=("F1",))
    assert wound.tensions == pytest.approx(reached.tensions, abs=1e-6)
    assert wound.tip == pytest.approx(reached.tip, abs=1e-9)


def test_a_pressed_finger_pulls_harder_where_it_was_pulled_more_before(model):
    up, down = (guide_history(model, [[first, 0.0, 0.01], [40.0, 0.0, 0.01]], FRICTION)[-1] for first in (20.0, 60.0))
    without = model.evaluate([40.0, 0.0, 0.01]).contact_force
    assert up.contact_forces[0] < without < down.contact_forces[0]


def test_a_finger_that_weighs_keeps_the_law_too(model):
    gravity = {"density": 1100.0, "direction": [0.0, -1.0, 0.0]}
    heavy = model.rod.assembled(model.rod.scene | {"gravity": gravity})
    finger = GuidedFinger(model=heavy, friction=FRICTION)
    state, bent = finger.advance([60.0, 0.0]), bends(finger)
    turned = np.cumsum(bent[::-1])[::-1] - bent / 2
    assert state.element_tensions[:, 0] == pytest.approx(60.0 * np.exp(-FRICTION * turned), rel=1e-6)
    assert state.tip[1] < GuidedFinger(model=model.rod, friction=FRICTION).advance([60.0, 0.0]).tip[1] - 1e-5


def test_straight_tendons_and_chambers_have_no_guides(chambered):
    loads = [4.0, 4e5, 1e5]
    free, rubbing = (GuidedFinger(model=chambered, friction=one).advance(loads) for one in (0.0, 0.3))
    assert free.shortenings == pytest.approx(chambered.shortening(loads), abs=1e-9)
    assert rubbing.element_tensions == pytest.approx(np.tile(loads, (len(rubbing.element_tensions), 1)))
    assert rubbing.tip == pytest.approx(free.tip, abs=1e-12) and rubbing.status == "converged"


def test_every_segment_of_a_finger_has_its_elements(model):
    rod = in_series(model.rod, 2)
    state = GuidedFinger(model=rod, friction=FRICTION).advance([30.0] + [0.0] * (len(rod.names) - 1))
    passed = state.element_tensions[:, 0]
    assert (
        state.status == "converged" and len(passed) == sum(map(len, rod.pieces)) and (passed[passed > 0] <= 30.0).all()
    )


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"friction": -0.1}, "friction must be a number of at least 0"),
        ({"friction": [0.1, 0.2, 0.3]}, "friction must be"),
        ({"friction": float("nan")}, "friction must be"),
        ({"friction": 0.1, "per_length": -1.0}, "per_length must be"),
    ],
)
def test_wrong_numbers_are_refused_in_one_line(model, given, says):
    with pytest.raises(ModelError, match=says):
        GuidedFinger(model=model, **given)


def test_wrong_points_are_refused_in_one_line(model):
    finger: GuidedFinger = GuidedFinger(model=model, friction=0.1)
    with pytest.raises(ModelError, match="point must be finite numbers F1, F2, d"):
        finger.advance([1.0, 2.0])
    with pytest.raises(ModelError, match="wound must be of F1, F2, got F9"):
        finger.advance([1.0, 2.0, 0.05], wound=("F9",))
    with pytest.raises(ModelError, match="increments must be at least 1"):
        guide_history(model, [[1.0, 2.0, 0.05]], 0.1, increments=0)


def test_tensions_beyond_the_trained_range_are_marked(model):
    rod: Rod = model.rod
    assert GuidedFinger(model=rod, friction=0.1).advance([500.0, 0.0]).status == "out_of_domain"
