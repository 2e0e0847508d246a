"""Points at which a finger's answers are put to the test: random, on the walls, chosen by a controller, and sought."""

from __future__ import annotations

import numpy as np

from control import Finger, Gripper
from rom import TouchedSegment
from rom.answer import FORCE, TOUCH

FORCES = 0.25, 4.0  # [N], that a controller is asked to hold
DEEPEST = 0.85  # of the way from where the plane is touched to the nearest plane [-]
SHALLOW = 0.05  # likewise, at least
ROUNDS, ALONG = 8, np.linspace(-0.3, 0.3, 13)  # line searches from a point; steps of each, of the box [-]
APART = 0.05  # of the box, that points which are sought lie from each other at least [-]
RADIUS = 0.025  # of the gripper whose fingers hold a cylinder [m]


def at_random(model: TouchedSegment, count: int, random: np.random.Generator) -> np.ndarray:
    """Uniformly in the box, shape (count, p): four distances of the plane at each of the tensions, soon solved."""
    lower, upper = model.limits
    points = np.repeat(lower + random.random((count // 4, len(lower))) * (upper - lower), 4, axis=0)
    points[:, -1] = lower[-1] + random.random(len(points)) * (upper - lower)[-1]
    return points[np.lexsort((-points[:, -1], np.arange(len(points)) // 4))]


def on_walls(model: TouchedSegment, count: int, random: np.random.Generator) -> np.ndarray:
    """Points in contact, one of the tensions 0 or the highest: two distances at each."""
    lower, upper = model.limits
    found = list[np.ndarray]()
    while len(found) < count:
        tensions = (lower + random.random(len(lower)) * (upper - lower))[:-1]
        k = random.integers(len(tensions))
        tensions[k] = (lower, upper)[random.integers(2)][k]
        pair = np.column_stack([np.tile(tensions, (2, 1)), _touched(model, tensions, random, 2)])
        if np.isfinite(pair).all() and model.evaluate(pair).inside.all():
            found += [*pair]
    return np.array(found)


def chosen(model: TouchedSegment, count: int, random: np.random.Generator) -> np.ndarray:
    """A third each: where `hold` presses, where `reach` brings a finger that a plane then meets, where `grasp` ends."""
    finger, gripper = Finger(model), Gripper(model, radius=RADIUS)
    lower, upper = model.limits
    found = list[np.ndarray]()
    while len(found) < count:
        drawn = lower + random.random(len(lower)) * (upper - lower)
        force = float(np.exp(random.uniform(*np.log(FORCES))))
        kind = len(found) % 3
        if kind == 0:
            motion = finger.hold(force, float(drawn[-1]), start=drawn[:-1])
            point = np.append(motion.tensions, drawn[-1])
        elif kind == 1:
            free = np.append(lower[:-1] + random.random(len(lower) - 1) * (upper - lower)[:-1], np.inf)
            motion = finger.reach(model.rod.rest + model.outputs(free[None])[0, :3])
            point = np.append(motion.tensions, _touched(model, motion.tensions, random, 1))
        else:
            centre = (2e-3 * random.uniform(-1, 1, 2)).tolist()
            distances = gripper.distances(centre, float(random.uniform(0.005, 0.020)))
            motion = gripper.fingers[0].hold(force, float(distances[0]))
            point = np.append(motion.tensions, distances[0])
        if motion.converged and (point >= lower).all() and (point <= upper).all():
            found.append(point)
    return np.array(found)


def sought(model: TouchedSegment, count: int, random: np.random.Generator, other: TouchedSegment) -> np.ndarray:
    """Points where the forces of two fingers differ most, over the first's estimate: by line searches from random ones.

    Args:
        model: whose estimates are put to the test.
        count: of points.
        random: of where a search begins, and of its lines.
        other: a finger that was trained on other states.
    """
    lower, upper = model.limits
    found = list[np.ndarray]()
    while len(found) < count:
        tensions = lower[:-1] + random.random(len(lower) - 1) * (upper - lower)[:-1]
        point = np.append(tensions, _touched(model, tensions, random, 1))
        if not np.isfinite(point).all():
            continue
        for _ in range(ROUNDS):
            line = random.standard_normal(len(lower))
            steps = point + ALONG[:, None] * (upper - lower) * line / np.linalg.norm(line)
            steps = np.clip(steps, lower, upper)
            point = steps[np.argmax(_surprise(model, other, steps))]
        apart = [np.linalg.norm((point - one) / (upper - lower)) for one in found]
        if min(apart, default=1.0) > APART and _surprise(model, other, point[None])[0] > 0:
            found.append(point)
    return np.array(found)


def _surprise(model: TouchedSegment, other: TouchedSegment, points: np.ndarray) -> np.ndarray:
    """Difference of the forces of two fingers over the estimate of the first, shape (n,); 0 where nothing is known."""
    answers, theirs = model.evaluate(points), other.answers(points)
    known = answers.inside & theirs.inside & (answers.contact_force > 0)
    estimates = np.where(known, answers.error["contact_force"], np.inf)
    return np.where(known, np.abs(answers.contact_force - theirs.out[:, FORCE]) / estimates, 0.0)


def _touched(model: TouchedSegment, tensions: np.ndarray, random: np.random.Generator, count: int) -> np.ndarray:
    """Distances of planes that the finger touches, from far to near, shape (count,) [m]; nan if there are none."""
    lower, upper = model.limits
    touch = min(model.outputs(np.append(tensions, np.inf)[None])[0, TOUCH], upper[-1])
    if not touch > lower[-1]:
        return np.full(count, np.nan)
    return np.sort(touch - random.uniform(SHALLOW, DEEPEST, count) * (touch - lower[-1]))[::-1]
