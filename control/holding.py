"""Tensions that press on a plane with a contact force, as a compiled problem of one residual.

It begins where the finger is. If that does not lead to an answer, it begins again at points of the atlas: so a target
is called unreachable only after the whole box was looked at.
"""

from __future__ import annotations

import numpy as np

from control.least_squares import advance
from control.problems import Atlas, Desk, Model, ask, desk_for, force_error
from control.room import CONVERGED, GOING, LIMIT, STATIONARY, TRIED, Rules, begin, copy
from rom.compiled import compiled
from rom.kernel import TOUCH

EVALUATIONS = 12.0  # from one start: an answer is near, or the start is no good
CROSSING = 12  # bisections
NEARLY = 0.8  # of a target's force in the atlas, above which more than one of its points is tried
ATTEMPTS = 5  # from other points of the atlas; and to stay before the plane, where the weight gives a little


@compiled(allocates=True)
def hold_once(
    model: Model, start: np.ndarray, target: float, distance: float, rules: Rules
) -> tuple[int, float, int, np.ndarray, float]:
    """See hold; also the tensions [N] and what the contact force may be off [N]."""
    desk = desk_for(model)
    status, missed, tried = hold(model, desk, start, target, distance, rules)
    ask(model, desk, desk.best, distance)
    return status, missed, tried, desk.best, force_error(model, desk)


@compiled
def hold(
    model: Model, desk: Desk, start: np.ndarray, target: float, distance: float, rules: Rules
) -> tuple[int, float, int]:
    """Find the tensions nearest to a start that press with a contact force [N] on a plane at a distance [m].

    Or, of a model that presses with its pad, with a pressure over the model's unit [N].

    Returns:
        status, |contact force - target| [N] and evaluations; the tensions are in desk.best.
    """
    status, missed, tried = _hold_from(model, desk, start, start, target, distance, rules)
    if status == CONVERGED:
        return status, missed, tried
    cost, force, most = -np.inf, np.inf, np.inf
    for attempt in range(ATTEMPTS):
        near, hard, nearest, hardest, most = _holding_nodes(
            model.atlas, start, desk.room.width, target, distance, cost, force
        )
        if most < target and attempt > 0 and hardest < NEARLY * target:
            break
        if attempt != 1 and most >= target:
            node, cost = near, nearest
        else:
            node, force = hard, hardest
        begun = model.atlas.tensions[node]
        status, missed, more = _hold_again(model, desk, begun, start, target, distance, missed, rules)
        tried += more
        if status != CONVERGED and _signed_force(model, desk, begun, distance) >= target:
            tried += _cross(model, desk, begun, target, distance)
            status, missed, more = _hold_again(model, desk, desk.between, start, target, distance, missed, rules)
            tried += more
        if status == CONVERGED:
            break
    if status == LIMIT and most < target:  # still creeping towards the hardest there is
        status = STATIONARY
    return status, missed, tried


@compiled
def _hold_again(
    model: Model,
    desk: Desk,
    start: np.ndarray,
    home: np.ndarray,
    target: float,
    distance: float,
    missed: float,
    rules: Rules,
) -> tuple[int, float, int]:
    """Try from elsewhere, and keep what was best: desk.best missed by this much."""
    copy(desk.best, desk.other)
    status, other, tried = _hold_from(model, desk, start, home, target, distance, rules)
    if status == CONVERGED or other <= missed:
        return status, other, tried
    copy(desk.other, desk.best)
    return STATIONARY, missed, tried


@compiled
def _hold_from(
    model: Model, desk: Desk, start: np.ndarray, home: np.ndarray, target: float, distance: float, rules: Rules
) -> tuple[int, float, int]:
    room, n = desk.room, len(start)
    begin(room, start, home)
    evaluations = min(rules.iterations, EVALUATIONS)
    rules = Rules(rules.residual, rules.longest, rules.step, rules.nearest, rules.homeward, evaluations)
    status = GOING
    while status == GOING:
        room.r_ahead[0] = _signed_force(model, desk, room.ahead, distance) - target
        row, weight = (model.row, 1.0 / model.unit) if distance < desk.out[TOUCH] else (TOUCH, model.atlas.stiffness)
        for j in range(n):
            room.jacobian_ahead[0, j] = weight * desk.jacobian[row, j]
        status = advance(room, rules)
    copy(room.x, desk.best)
    ask(model, desk, room.x, distance)
    return status, abs(desk.out[model.row] / model.unit - target), int(room.numbers[TRIED])


@compiled
def _signed_force(model: Model, desk: Desk, tensions: np.ndarray, distance: float) -> float:
    """Contact force [N]; before touch minus the stiffness of contact times the gap.

    There the force is zero whatever the tensions, and would not tell where to go. The gap does.
    """
    ask(model, desk, tensions, distance)
    gap = distance - desk.out[TOUCH]
    return desk.out[model.row] / model.unit if gap < 0.0 else -model.atlas.stiffness * gap


@compiled
def _cross(model: Model, desk: Desk, hard: np.ndarray, target: float, distance: float) -> int:
    """Write where the target is crossed between the gentlest tensions and some that press harder into desk.between.

    By bisection, which finds it in a force that is neither monotone nor smooth. Returns the evaluations.
    """
    low, high = 0.0, 1.0
    for _ in range(CROSSING):
        middle = 0.5 * (low + high)
        for j in range(len(hard)):
            desk.between[j] = model.lower[j] + middle * (hard[j] - model.lower[j])
        if _signed_force(model, desk, desk.between, distance) < target:
            low = middle
        else:
            high = middle
    return CROSSING


@compiled
def _holding_nodes(
    atlas: Atlas, home: np.ndarray, width: np.ndarray, target: float, distance: float, cost: float, force: float
) -> tuple[int, int, float, float, float]:
    """Points of the atlas to begin from: one of about the target's force and not far from home, and the hardest.

    Returns:
        the first, of the least cost above `cost`, and the second, of the most force below `force`; their cost and
        force; and the most force of all.
    """
    below, last = 0, len(atlas.distances) - 1
    while below < last - 1 and atlas.distances[below + 1] <= distance:
        below += 1
    above = min(below + 1, last)
    step = atlas.distances[above] - atlas.distances[below]
    share = (distance - atlas.distances[below]) / step if step > 0.0 else 0.0
    near, hard, nearest, hardest, most = 0, 0, np.inf, -np.inf, -np.inf
    for k in range(len(atlas.tensions)):
        here = (1.0 - share) * atlas.contact_forces[below, k] + share * atlas.contact_forces[above, k]
        if not here > 0.0:
            here = min((atlas.touch_distances[k] - distance) * atlas.stiffness, 0.0)
        most = max(most, here)
        if hardest < here < force:
            hard, hardest = k, here
        own = (here / target - 1.0) ** 2
        for j in range(len(home)):
            own += ((atlas.tensions[k, j] - home[j]) / width[j]) ** 2
        if cost < own < nearest:
            near, nearest = k, own
    return near, hard, nearest, hardest, most
