"""Extremes of what is asked of a trained model, and of the controllers: any number, any target."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from control import Finger
from control.motion import Motion
from rom import TouchedSegment
from studies.control.models import finger as bundled
from studies.extremes.verdicts import Refused, Row, judged

MODEL, CONTROL = "bundled finger", "control"


def rows(queries: int) -> Iterator[Row]:
    """All of them, of the bundled finger before the paper's plane."""
    model = bundled()
    yield from anything(model, queries)
    yield from targets(model)


def wild(model: TouchedSegment, count: int, seed: int) -> np.ndarray:
    """Random points: in the box, on its walls, far beyond, not numbers, infinite, next to nothing."""
    random = np.random.default_rng(seed)
    lower, upper = model.limits
    points = lower + random.uniform(-0.5, 1.5, (count, len(lower))) * (upper - lower)
    odd = np.array([np.nan, np.inf, -np.inf, 1e300, -1e300, 5e-324, 0.0, -0.0, *lower, *upper])
    swapped = random.random(points.shape) < 0.15
    points[swapped] = random.choice(odd, swapped.sum())
    return points


def anything(model: TouchedSegment, queries: int) -> Iterator[Row]:
    """Queries of every kind."""
    points = wild(model, queries, 0)
    lower, upper = model.limits
    found = model.evaluate(points)

    def finite() -> float:
        answers = np.column_stack([found.tip, found.contact_force, found.touch_distance])
        return float(np.mean(~np.isfinite(answers).all(axis=1)))

    def marked() -> float:
        outside = ~((points >= lower) & (points <= upper)).all(axis=1)
        away = points[:, -1] == np.inf  # no plane
        inside = ((points >= lower) & (points <= upper))[:, :-1].all(axis=1) & away
        return float(np.mean(found.inside & outside & ~inside))

    def alone() -> float:
        some = points[:2000]
        together, ones = model.evaluate(some), [model.evaluate(point) for point in some]
        worst = max(
            float(np.abs(np.array([one.contact_force for one in ones]) - together.contact_force).max()),
            float(np.abs(np.array([one.tip for one in ones]) - together.tip).max()),
        )
        return worst if all(one.inside == both for one, both in zip(ones, together.inside, strict=True)) else np.inf

    count = f"{queries:,} random points with nan and infinities"
    yield judged(MODEL, "query", count, "share of answers that are no numbers", 0.0, finite)
    yield judged(MODEL, "query", count, "share outside that is not marked", 0.0, marked)
    yield judged(MODEL, "query", "2,000 of them", "one by one and together", 1e-12, alone)
    for point in ([50.0], [[[50.0, 0.0, 0.01]]], "finger"):
        yield judged(MODEL, "query", f"{point}", "", 0.0, partial(force_at, model, point))


def targets(model: TouchedSegment) -> Iterator[Row]:
    """Targets at, inside and outside what can be done."""
    finger = Finger(model)
    grid = np.stack(np.meshgrid(*[np.linspace(0, 100, 201)] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    for distance in (model.limits[0][-1], 0.010, 0.020):
        forces = model.evaluate(np.column_stack([grid, np.full(len(grid), distance)])).contact_force
        for share in (1e-6, 0.5, 1 - 1e-9, 1.0, 1.05, 1e6):
            target = float(forces.max() * share)

            def held(target: float = target, distance: float = distance) -> float:
                motion = done(finger.hold(target, distance, tolerance=min(1e-6, 1e-4 * target)))
                return abs(float(model.evaluate([*motion.tensions, distance]).contact_force) / target - 1)

            yield judged(
                CONTROL, f"hold at d = {1e3 * distance:g} mm", f"{share!r} of the most", "the model's force", 1e-3, held
            )
    for tensions in ([0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [1e-9, 0.0]):
        goal = finger.rest + model.evaluate([*tensions, np.inf]).tip

        def reached(goal: np.ndarray = goal) -> float:
            motion = done(finger.reach(goal))
            return float(np.linalg.norm(finger.rest + model.evaluate([*motion.tensions, np.inf]).tip - goal)) / 0.05

        yield judged(
            CONTROL,
            "reach",
            f"the tip at {tensions[0]:g} and {tensions[1]:g} N",
            "the model's tip, over the length",
            2e-3,
            reached,
        )
    for goal in ([1.0, 0.0, 0.0], [0.0, 1e200, 0.0], [np.nan, 0.0, 0.0]):
        yield judged(CONTROL, "reach", f"{goal}", "", 0.0, partial(residual, finger.reach, goal))
    for distance in (model.limits[0][-1], 0.010):
        felt = float(model.evaluate([60.0, 10.0, distance]).contact_force)

        def located(felt: float = felt, distance: float = distance) -> float:
            found = finger.locate([60.0, 10.0], felt)
            if found.status != "converged":
                raise Refused(found.status)
            return abs(found.distance - distance) / distance

        yield judged(CONTROL, "locate", f"d = {1e3 * distance:g} mm", "the plane's place", 1e-3, located)
    for force in (0.0, -1.0, 1e9, np.nan, np.inf):
        yield judged(
            CONTROL,
            "locate",
            f"{force:g} N felt",
            "",
            0.0,
            partial(residual, finger.locate, [60.0, 10.0], force),
        )
    for force in (0.0, -1.0, np.nan, np.inf):
        yield judged(CONTROL, "hold", f"{force:g} N", "", 0.0, partial(residual, finger.hold, force, 0.010))
    for distance in (-1.0, 0.0, 1e9, np.nan):
        yield judged(
            CONTROL,
            "hold",
            f"1 N at d = {distance:g} m",
            "",
            0.0,
            partial(residual, finger.hold, 1.0, distance),
        )


def force_at(model: TouchedSegment, point: ArrayLike) -> float:
    """The contact force that a model answers [N]."""
    return float(model.evaluate(point).contact_force)


def residual(command: Callable[..., Motion], *wanted: ArrayLike) -> float:
    """How far a command that converged stays from what was wanted."""
    return done(command(*wanted)).residual


def done(motion: Motion) -> Motion:
    """A motion that converged, or its status as a refusal."""
    if motion.status != "converged":
        raise Refused(motion.status)
    return motion
