"""Tensions that bring the tip to a point before a plane, as a compiled problem of four residuals.

It begins where the finger is. If that does not lead there, it begins once more at the nearest point of the atlas.
"""

from __future__ import annotations

import numpy as np

from control.least_squares import advance
from control.problems import Atlas, Desk, Model, ask, desk_for
from control.room import CONVERGED, GOING, STATIONARY, TRIED, Rules, begin, copy
from rom.compiled import compiled
from rom.kernel import TOUCH

PASSED = 10.0  # weight of passing the plane against missing the point
NEARER = 6  # bisections back towards it
SHIFTS = 5  # of the plane to stay before, as the weight gives a little


@compiled(allocates=True)
def reach_once(
    model: Model, start: np.ndarray, change: float, target: np.ndarray, distance: float, rules: Rules
) -> tuple[int, float, int, np.ndarray]:
    """See reach; also the tensions [N]. If no tension may change by more than `change` [N], from the start only."""
    desk, anywhere = desk_for(model, 4), not np.isfinite(change)
    if not anywhere:
        for j in range(len(start)):
            desk.room.lower[j] = max(start[j] - change, model.lower[j])
            desk.room.upper[j] = min(start[j] + change, model.upper[j])
    status, missed, tried = reach(model, desk, start, target, distance, rules, anywhere)
    return status, missed, tried, desk.best


@compiled
def reach(
    model: Model, desk: Desk, start: np.ndarray, target: np.ndarray, distance: float, rules: Rules, anywhere: bool
) -> tuple[int, float, int]:
    """Find the tensions, nearest to a start, that displace the tip to a target [m] without touching a plane.

    If not anywhere, only from the start on.

    Returns:
        status, |tip - target| [m] and evaluations; the tensions are in desk.best.
    """
    status, missed, tried = _reach_before(model, desk, start, start, target, distance, rules)
    if status == CONVERGED or not anywhere:
        return status, missed, tried
    node = _reaching_node(model.atlas, target, distance)
    copy(desk.best, desk.other)
    passing = _passed(model, desk, desk.best, distance) > 0.0
    again, other, more = _reach_before(model, desk, model.atlas.tensions[node], start, target, distance, rules)
    if again == CONVERGED or passing or (other <= missed and not _passed(model, desk, desk.best, distance) > 0.0):
        return again, other, tried + more
    copy(desk.other, desk.best)
    return status, missed, tried + more


@compiled
def _passed(model: Model, desk: Desk, tensions: np.ndarray, distance: float) -> float:
    """How far the plane is passed [m]; nan without an obstacle."""
    ask(model, desk, tensions, np.inf)
    return desk.out[TOUCH] - distance


@compiled
def _reach_before(
    model: Model, desk: Desk, start: np.ndarray, home: np.ndarray, target: np.ndarray, distance: float, rules: Rules
) -> tuple[int, float, int]:
    status, tried, plane, passed = GOING, 0, distance, 0.0
    copy(start, desk.best)
    for k in range(SHIFTS):
        status = _reach_from(model, desk, desk.best, home, target, plane, rules)
        tried += int(desk.room.numbers[TRIED])
        passed = _passed(model, desk, desk.best, distance)
        if not passed > 0.0:
            tried += _nearer(model, desk, distance) if k > 0 else 0
            break
        copy(desk.best, desk.between)
        plane -= 2.0**k * 1.5 * passed + 0.05 * rules.residual
    missed = 0.0
    for i in range(3):
        missed += (desk.out[i] - target[i]) ** 2
    missed = np.sqrt(missed)
    if passed > 0.0 and status == CONVERGED:
        status = STATIONARY
    elif not passed > 0.0 and missed <= rules.residual:  # shifted planes were missed, this one is not
        status = CONVERGED
    return status, missed, tried


@compiled
def _nearer(model: Model, desk: Desk, distance: float) -> int:
    """Move desk.best, which leaves the plane, as near as may be to desk.between, which passes it; the evaluations."""
    for _ in range(NEARER):
        for j in range(len(desk.best)):
            desk.room.ahead[j] = 0.5 * (desk.best[j] + desk.between[j])
        if _passed(model, desk, desk.room.ahead, distance) > 0.0:
            copy(desk.room.ahead, desk.between)
        else:
            copy(desk.room.ahead, desk.best)
    _passed(model, desk, desk.best, distance)
    return NEARER + 1


@compiled
def _reach_from(
    model: Model, desk: Desk, start: np.ndarray, home: np.ndarray, target: np.ndarray, plane: float, rules: Rules
) -> int:
    room, n = desk.room, len(start)
    begin(room, start, home)
    status = GOING
    while status == GOING:
        ask(model, desk, room.ahead, np.inf)
        passed = desk.out[TOUCH] - plane
        for i in range(3):
            room.r_ahead[i] = desk.out[i] - target[i]
            for j in range(n):
                room.jacobian_ahead[i, j] = desk.jacobian[i, j]
        room.r_ahead[3] = PASSED * passed if passed > 0.0 else 0.0
        for j in range(n):
            room.jacobian_ahead[3, j] = PASSED * desk.jacobian[TOUCH, j] if passed > 0.0 else 0.0
        status = advance(room, rules)
    copy(room.x, desk.best)
    return status


@compiled
def _reaching_node(atlas: Atlas, target: np.ndarray, distance: float) -> int:
    """Point of the atlas nearest to the target before the plane; at rest if all pass it."""
    found, least = 0, np.inf
    for k in range(len(atlas.tensions)):
        if atlas.touch_distances[k] > distance:
            continue
        away = 0.0
        for i in range(3):
            away += (atlas.tips[k, i] - target[i]) ** 2
        if away < least:
            found, least = k, away
    return found
