"""Two thousand targets from starts at bounds and without tension: what is met is said to be, and nothing else is."""

import numpy as np
import pytest

from control import Finger

COUNT = 1000  # of targets that can be met, and of others
TOLERANCE = 1e-4  # [m]


def starts(finger: Finger) -> list[np.ndarray]:
    """At rest, at every corner of the tensions, and in the middle."""
    lower, upper = finger.lower, finger.upper
    corners = [np.where([k >> j & 1 for j in range(len(lower))], upper, lower) for k in range(2 ** len(lower))]
    return [*corners, (lower + upper) / 2]


def pulled(finger: Finger, random: np.random.Generator) -> np.ndarray:
    """Tensions inside, at one bound and at several, shape (COUNT, tensions) [N]."""
    share = random.random((COUNT, len(finger.lower)))
    at_bounds = random.random(share.shape) < 0.25
    share[at_bounds] = random.integers(0, 2, at_bounds.sum())
    return finger.lower + share * (finger.upper - finger.lower)


def free_tips(finger: Finger, tensions: np.ndarray) -> np.ndarray:
    """Displacements of the free tip, shape (n, 3) [m]."""
    return finger.model.outputs(np.column_stack([tensions, np.full(len(tensions), np.inf)]))[:, :3]


def test_a_point_is_converged_exactly_where_the_tip_gets_to_it(finger):
    random = np.random.default_rng(0)
    meant = free_tips(finger, pulled(finger, random))
    goals = np.vstack([meant, random.uniform(-0.05, 0.05, (COUNT, 3))])
    axes = [np.linspace(*ends, 101) for ends in zip(finger.lower, finger.upper, strict=True)]
    grid = free_tips(finger, np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, len(axes)))
    begun, met = starts(finger), 0
    for k, goal in enumerate(goals):
        motion = finger.reach(finger.rest + goal, start=begun[k % len(begun)], tolerance=TOLERANCE)
        sides = np.array([1, *motion.sides])
        missed = np.linalg.norm(free_tips(finger, motion.tensions[None])[0] * sides - goal)
        assert motion.residual == pytest.approx(missed, abs=1e-12)
        assert motion.status == ("converged" if missed <= TOLERANCE else "unreachable")
        assert k >= COUNT or motion.converged
        assert motion.converged or missed <= np.linalg.norm(grid * sides - goal, axis=1).min() + TOLERANCE
        met += motion.converged
    assert COUNT <= met < 1.1 * COUNT


def test_a_force_is_converged_exactly_where_the_model_presses_with_it(finger):
    random, model, begun = np.random.default_rng(1), finger.model, starts(finger)
    lower, upper = (end[-1] for end in model.limits)
    tensions, distances = pulled(finger, random), random.uniform(lower, upper, COUNT)
    answer = model.evaluate(np.column_stack([tensions, distances]))
    can = np.asarray(answer.inside) & (answer.contact_force > 0.01)
    targets = np.where(can, answer.contact_force, 10 ** random.uniform(-1.5, 1.5, COUNT))
    statuses = set()
    for k, (target, d) in enumerate(zip(targets, distances, strict=True)):
        for start in (begun[k % len(begun)], begun[(k + 1) % len(begun)]):
            motion = finger.hold(float(target), float(d), start=start)
            there = model.evaluate([*motion.tensions, d])
            missed = abs(float(there.contact_force) - target)
            assert motion.converged == (bool(there.inside) and missed <= 1.1e-6)
            assert motion.converged or not can[k]
            assert motion.status != "unreachable" or (there.inside and missed > 0.9e-6)
            statuses.add(motion.status)
    assert {"converged", "unreachable"} <= statuses
