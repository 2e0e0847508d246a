"""Points at which a finger's answers are put to the test: random ones, a controller's own, and the worst."""

from __future__ import annotations

import numpy as np

from control import Finger
from rom import TouchedSegment
from rom.native.answer import FORCE, TOUCH

POOL = 20_000  # of random points, among which the worst are
FORCES = 0.25, 4.0  # [N], that a controller is asked to hold
SMALL = 0.01, 0.1  # [N]
STEP = 5e-5  # of the plane [m], across which contact changes its kind
HIGH = 0.9  # of both tensions' ranges


def at_random(model: TouchedSegment, count: int, random: np.random.Generator) -> np.ndarray:
    """Uniformly in the box, shape (count, p)."""
    lower, upper = model.limits
    return lower + random.random((count, len(lower))) * (upper - lower)


def in_fours(model: TouchedSegment, count: int, random: np.random.Generator) -> np.ndarray:
    """The same, four distances of the plane at each of the tensions: soon solved."""
    points = np.repeat(at_random(model, count // 4, random), 4, axis=0)
    points[:, -1] = at_random(model, len(points), random)[:, -1]
    return points[np.lexsort((-points[:, -1], np.arange(len(points)) // 4))]


def held(model: TouchedSegment, count: int, random: np.random.Generator) -> np.ndarray:
    """Where a controller holds random forces on random planes, from random starts."""
    finger, found = Finger(model), list[list[float]]()
    while len(found) < count:
        *start, distance = at_random(model, 1, random)[0]
        motion = finger.hold(float(np.exp(random.uniform(*np.log(FORCES)))), float(distance), start=start)
        if motion.converged:
            found.append([*motion.tensions, distance])
    return np.array(found)


def worst(model: TouchedSegment, count: int, random: np.random.Generator) -> np.ndarray:
    """A quarter each: small forces; both tensions high; the nearest planes; where contact changes its kind."""
    points = at_random(model, POOL, random)
    answers = model.answers(points)
    force, touched = answers.out[:, FORCE], answers.inside & (answers.out[:, FORCE] > 0)
    points, force, touch = points[touched], force[touched], answers.out[touched, TOUCH]
    lower, upper = model.limits
    size = upper - lower
    kinds = [
        (force > SMALL[0]) & (force < SMALL[1]),
        ((points - lower)[:, :-1] > HIGH * size[:-1]).all(axis=1),
        points[:, -1] <= np.quantile(points[:, -1], 0.05),
        _changes(model, points) & (touch - points[:, -1] > 2 * STEP),
    ]
    return np.concatenate([random.permutation(points[kind])[: count // len(kinds)] for kind in kinds])


def _changes(model: TouchedSegment, points: np.ndarray) -> np.ndarray:
    """Whether the point that presses moves otherwise before than after, as the plane comes nearer, shape (n,)."""
    step = STEP * np.eye(points.shape[1])[-1]
    farther, here, nearer = (model.answers(points + k * step) for k in (1, 0, -1))
    with np.errstate(invalid="ignore"):
        arms = [one.wrenches[:, 3:6] / one.out[:, [FORCE]] for one in (farther, here, nearer)]
    before, after = np.diff(arms, axis=0)
    jump = np.linalg.norm(after - before, axis=1)
    jump[~(nearer.inside & farther.inside) | (farther.out[:, FORCE] <= 0)] = 0.0
    return np.asarray(jump > np.quantile(jump, 0.98))
