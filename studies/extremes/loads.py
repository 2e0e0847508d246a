"""Extremes of what a finger is exposed to: tensions, planes, paths to one load."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from fingerfem.equilibrium.failures import LoadNotReached
from studies.extremes.fingers import PART, SAME, apart, changed, draft, model, solved
from studies.extremes.verdicts import Refused, Row, judged


def rows() -> Iterator[Row]:
    """All of them."""
    yield from loads()
    yield from planes()
    yield from paths(6)


def loads() -> Iterator[Row]:
    """Tensions from next to nothing to where there is no equilibrium."""
    free = changed(draft(), obstacle=None)
    wide = changed(free, tendons=[tendon | {"tension": [0.0, 1e4]} for tendon in free["tendons"]])
    finger = model(wide)
    slope = np.asarray(solved(finger, [0.0, 0.0]).sensitivities["tip"]["F1"])  # type: ignore[index]
    for tension in (1e-9, 1e-6, 1e-3):

        def small(tension: float = tension) -> float:
            return apart(solved(finger, [tension, 0.0]).tip, tension * slope)

        # The tip is a difference of places: round-off of the finger's length is left in it.
        lost = 10 * np.finfo(float).eps * 0.05 / (tension * np.linalg.norm(slope))
        yield judged(PART, "tension", f"{tension:g} N", "the linear answer", 0.1 * tension + lost, small)
    for tension in (100.0, 200.0, 400.0, 800.0, 1600.0, 1e4):

        def large(tension: float = tension) -> float:
            direct = solved(finger, [tension, tension / 4])
            finger.continuation.rest()
            finger.continuation.advance([0.0, tension / 4], None)
            finger.continuation.advance([tension, tension / 4], None)
            return apart(finger.problem.tip(), direct.tip)

        yield judged(PART, "tension", f"{tension:g} and {tension / 4:g} N", "another path to it", SAME, large)
    yield judged(
        PART, "tension", "beyond the scene's range", "", 0.0, lambda: float(solved(model(draft()), [101.0, 0.0]).tip[0])
    )
    opposite = [wide["tendons"][0] | {"name": name, "offset": [y, 0.0]} for name, y in (("F1", 0.004), ("F3", -0.004))]
    pair = model(changed(wide, tendons=opposite))
    for tension in (1.0, 100.0, 1e4):

        def straight(tension: float = tension) -> float:
            pair.continuation.rest()
            pair.continuation.advance([tension, 0.0], None)
            pair.continuation.advance([tension, tension], None)
            by_turns, at_once = pair.problem.tip(), solved(pair, [tension, tension]).tip
            return max(abs(at_once[1]), abs(by_turns[1]), abs(by_turns[0] - at_once[0])) / abs(at_once[0])

        what = "straight, and the same by turns"
        yield judged(PART, "a tendon against its opposite", f"{tension:g} N each", what, SAME, straight)


def planes() -> Iterator[Row]:
    """Planes that touch at rest, or where the finger hardly reaches, or cut into it."""
    table = changed(draft(), obstacle={"distance": [1e-9, 0.031]})
    finger = model(table)
    at_rest = model(changed(draft(), obstacle={"distance": [1e-12, 0.031]}))
    reach = solved(finger, [50.0, 0.0]).touch_distance
    assert reach is not None

    def force(distance: float, tensions: list[float]) -> float:
        found = solved(finger, tensions, distance).contact_force
        assert found is not None
        return found

    yield judged(
        PART,
        "plane",
        "d = 0",
        "",
        0.0,
        lambda: model(changed(draft(), obstacle={"distance": [0.0, 0.031]})).problem.energy(),
    )
    yield judged(PART, "plane", "d = -1 mm", "", 0.0, lambda: force(-0.001, [50.0, 0.0]))
    yield judged(PART, "plane", "1e-9 m from rest, no tension", "no force", 0.0, lambda: force(1e-9, [0.0, 0.0]))

    def resting() -> float:
        """The finger lies on the plane and is pulled towards it: what carries is known by the balance alone."""
        state = solved(at_rest, [10.0, 0.0], 1e-12)
        assert state.contact_force
        return abs(state.clamp_reaction[1] - state.contact_force) / state.contact_force

    yield judged(PART, "plane", "touching at rest (1e-12 m), 10 N", "the clamp's reaction", SAME, resting)
    for off in (1e-9, 1e-6):
        yield judged(
            PART, "plane", f"{off:g} m out of reach", "no force", 0.0, partial(force, reach + off, [50.0, 0.0])
        )

        def inside(off: float = off) -> float:
            near, nearer = (force(reach - share * off, [50.0, 0.0]) for share in (1.0, 2.0))
            return abs(nearer / near - 2)

        yield judged(PART, "plane", f"{off:g} m in reach", "force grows with the way", 0.05, inside)


def paths(count: int) -> Iterator[Row]:
    """Detours to one load."""
    finger = model(draft())
    direct = solved(finger, [60.0, 40.0], 0.006)
    assert direct.contact_force is not None
    pressed = direct.contact_force
    random = np.random.default_rng(7)
    for k in range(count):

        def detour() -> float:
            continuation = finger.continuation
            continuation.rest()
            for _ in range(3):
                continuation.advance(random.uniform(0, 100, 2), None)
            continuation.advance(random.uniform([40, 0], [100, 60]), random.uniform(0.004, 0.010))
            continuation.advance(random.uniform([40, 0], [100, 60]), random.uniform(0.004, 0.010))
            try:
                continuation.advance([60.0, 40.0], 0.006)
            except LoadNotReached as failure:
                raise Refused(str(failure)) from None
            pressing = finger.problem.scalar(finger.problem.forms.contact[0].force)
            return max(apart(finger.problem.tip(), direct.tip), abs(pressing / pressed - 1))

        yield judged(PART, "path to a load", f"random, number {k + 1}", "the direct path", SAME, detour)
