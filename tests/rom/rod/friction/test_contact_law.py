"""Signorini's and Coulomb's laws as equations: their zeros are the laws' states, their matrices are derivatives."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rom.rod.friction.contact_law import OPEN, SLIDES, STICKS, law

NUMBERS = st.integers(0, 10_000)
FRICTION, COMPLIANCE, STIFFNESS = 0.4, 3e-6, 2e5  # [-], [m/N], [N/m]: at most 1 / c


def solved(forces, motions, before=(0.0, 0.0), friction=FRICTION):
    """The equations at one contact."""
    one = [np.array([part], float) for part in (forces, motions, before, COMPLIANCE, STIFFNESS)]
    return law(*one, friction)


def at_rest(normal, along, slip=(0.0, 0.0), before=(0.0, 0.0)):
    """Motions at which a contact with these forces is closed and slips so far."""
    return np.array([0.0, *slip]) - COMPLIANCE * np.array([normal, *np.subtract(along, before)])


@given(NUMBERS)
def test_states_that_keep_both_laws_are_zeros(seed):
    random = np.random.default_rng(seed)
    normal, angle = random.uniform(0.1, 5), random.uniform(0, 2 * np.pi)
    way = np.array([np.cos(angle), np.sin(angle)])
    before, gap, far = random.standard_normal(2), random.uniform(0, 1e-3), 10 ** random.uniform(-8, -3)
    apart = solved([0, 0, 0], [gap, *random.standard_normal(2)], before)
    held = random.uniform(0, 0.99) * FRICTION * normal * way
    sticking = solved([normal, *held], at_rest(normal, held, before=before), before)
    most, slip = FRICTION * normal * way, -far * way  # of the finger, against the force on it
    sliding = solved([normal, *most], at_rest(normal, most, slip, before), before)
    for found, state in ((apart, OPEN), (sticking, STICKS), (sliding, SLIDES)):
        assert found.states == [state]
        assert found.residuals == pytest.approx(np.zeros((1, 3)), abs=1e-9)
    assert sliding.slips[0] == pytest.approx(slip, rel=1e-9) and not sticking.slips.any()
    assert most @ sliding.slips[0] < 0  # friction takes work


def test_states_that_break_a_law_are_no_zeros():
    along = np.array([FRICTION, 0.0])
    wrong = {
        "pulls": solved([-1, 0, 0], [0, 0, 0]),
        "presses from afar": solved([1, 0, 0], [1e-3, 0, 0]),
        "is inside": solved([0, 0, 0], [-1e-3, 0, 0]),
        "holds too much": solved([1, *2 * along], at_rest(1, 2 * along)),
        "slides with the force": solved([1, *along], at_rest(1, along, 1e-4 * along)),
        "slides below the most": solved([1, *along / 2], at_rest(1, along / 2, -1e-4 * along)),
    }
    sizes = {name: np.abs(found.residuals).max() for name, found in wrong.items()}
    assert min(sizes.values()) > 0.1, sizes


@given(NUMBERS)
def test_matrices_are_differences_of_the_residuals(seed):
    random, m, h = np.random.default_rng(seed), 30, 1e-7
    forces, before = random.standard_normal((m, 3)), random.standard_normal((m, 2))
    compliances, stiffness = random.uniform(0, 1e-5, m), random.uniform(1e3, 1e5, m)
    motions, rest = random.standard_normal((m, 3)) / stiffness[:, None], (before, compliances, stiffness, 0.5)
    found = law(forces, motions, *rest)
    for axis in range(3):
        unit = h * np.eye(3)[axis]
        far = unit / stiffness[:, None]
        ends = [law(forces + sign * unit, motions, *rest) for sign in (1, -1)]
        ends += [law(forces, motions + sign * far, *rest) for sign in (1, -1)]
        smooth = np.all([one.states == found.states for one in ends], axis=0)  # at a kink there is no derivative
        by_force, by_motion = ((a.residuals - b.residuals)[smooth] / (2 * h) for a, b in (ends[:2], ends[2:]))
        assert by_force == pytest.approx(found.by_forces[smooth, :, axis], abs=1e-5)
        assert by_motion == pytest.approx((found.by_motions / stiffness[:, None, None])[smooth, :, axis], abs=1e-5)
        assert smooth.sum() > m - 3


@given(st.floats(0, 2 * np.pi), NUMBERS)
def test_a_turn_of_the_tangents_turns_the_residuals(angle, seed):
    random = np.random.default_rng(seed)
    turn = np.eye(3)
    turn[1:, 1:] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    forces, motions, before = random.standard_normal(3), 1e-5 * random.standard_normal(3), random.standard_normal(2)
    one, other = solved(forces, motions, before), solved(turn @ forces, turn @ motions, turn[1:, 1:] @ before)
    assert one.states == other.states
    assert other.residuals[0] == pytest.approx(turn @ one.residuals[0], abs=1e-9)
    assert other.slips[0] == pytest.approx(turn[1:, 1:] @ one.slips[0], abs=1e-12)
