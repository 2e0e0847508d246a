"""Bounded Levenberg-Marquardt for a handful of unknowns: minimise |r(x)|^2 / 2 with lower <= x <= upper.

Damping by the gain ratio (Nielsen, IMM-REP-1999-05, DTU 1999); bounds by projection, with the variables that the
gradient pushes against their bound left out of the step. A step is a linear least-squares problem, solved by
Householder reflections (normal equations would square the condition). Where many points solve the problem, as two
tensions hold one force, the way goes on along them to the one nearest to the start (projected gradient of the distance,
the residual corrected at every step).

Compiled, and without allocation once there is a `Room`. The residual is asked for by returning: `begin` and `advance`
leave a point in `room.ahead`; whoever calls writes residual and Jacobian there and calls `advance`, which says GOING
until it is done. So the same code serves compiled controllers and functions of Python (`minimise`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from control.householder import solve
from control.nearest import go_home, keep, towards_home
from control.room import (
    CONVERGED,
    COST,
    DAMPING,
    GOING,
    GROWTH,
    LIMIT,
    SHARE,
    SOLVED,
    STATIONARY,
    STATUS,
    TRIED,
    Room,
    Rules,
    accept,
    begin,
    largest,
    longest,
    look,
    room_for,
)
from rom.compiled import compiled


@compiled
def advance(room: Room, rules: Rules) -> int:
    """Judge what was found at room.ahead, and say where to look next: GOING, or why it is done and x the answer."""
    numbers = room.numbers
    numbers[TRIED] += 1.0
    cost = 0.0
    for i in range(len(room.r_ahead)):
        cost += 0.5 * room.r_ahead[i] ** 2
    if numbers[SOLVED] > 0.0:
        return go_home(room, rules, cost)
    status = _descend(room, rules, cost)
    if status == CONVERGED:
        numbers[SOLVED], numbers[SHARE] = numbers[TRIED], 1.0
        room.step[:] = 0.0
        keep(room)
        return towards_home(room, rules)
    return status


@compiled
def _descend(room: Room, rules: Rules, cost: float) -> int:
    """Levenberg-Marquardt: accept or refuse the point ahead, and look for the next."""
    numbers = room.numbers
    first = numbers[TRIED] == 1.0
    settled = not first and longest(room.step) <= rules.step
    if first or cost < numbers[COST]:  # nan is not below
        settled = settled and numbers[COST] - cost <= rules.step * numbers[COST]
        if not first:
            expected = numbers[COST] - _predicted(room)
            gain = (numbers[COST] - cost) / expected if expected > 0.0 else 0.0
            numbers[DAMPING] *= max(0.1, 1.0 - (2.0 * gain - 1.0) ** 3)
            numbers[GROWTH] = 2.0
        accept(room, cost)
    else:
        numbers[DAMPING] *= numbers[GROWTH]
        numbers[GROWTH] *= 2.0
    if np.sqrt(2.0 * numbers[COST]) <= rules.residual:
        return CONVERGED
    if settled:
        return STATIONARY
    if numbers[TRIED] >= rules.iterations:
        return LIMIT
    return GOING if _step(room, rules) else STATIONARY


@compiled
def _predicted(room: Room) -> float:
    """The cost that the linear model had expected ahead."""
    found = 0.0
    for i in range(len(room.r)):
        row = room.r[i]
        for j in range(len(room.x)):
            row += room.jacobian[i, j] * room.step[j]
        found += 0.5 * row * row
    return found


@compiled
def _step(room: Room, rules: Rules) -> bool:
    """Write the next step and the point ahead; False where no step would help."""
    numbers = room.numbers
    steepest = 0.0
    for j in range(len(room.x)):
        slope = 0.0
        for i in range(len(room.r)):
            slope += room.jacobian[i, j] * room.r[i]
        held = (room.x[j] <= room.lower[j] and slope >= 0.0) or (room.x[j] >= room.upper[j] and slope <= 0.0)
        room.free[j] = not held
        if not held:
            steepest = max(steepest, abs(slope))
    if steepest <= 1e-14 * max(np.sqrt(2.0 * numbers[COST]), 1e-300):
        return False
    if numbers[DAMPING] < 0.0:
        numbers[DAMPING] = 1e-4 * largest(room)
    for i in range(len(room.r)):
        room.right[i] = -room.r[i]
    solve(room, numbers[DAMPING])
    look(room, rules.longest)
    return True


RULES = Rules()


@dataclass(frozen=True, kw_only=True)
class Solution:
    """Where it stopped and why: "converged", "stationary" (a minimum above the tolerance) or "iteration_limit"."""

    x: np.ndarray
    residual: float
    status: str
    iterations: int


def minimise(
    residual: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
    start: np.ndarray,
    bounds: tuple[np.ndarray, np.ndarray],
    rules: Rules = RULES,
) -> Solution:
    """Find the least residual from a start; of many solutions the one nearest to it, over the bounds' width.

    Args:
        residual: x, shape (n,), to r, shape (m,), and dr/dx, shape (m, n).
        start: shape (n,); moved into the bounds.
        bounds: lower and upper, shapes (n,); equal where a variable is fixed.
        rules: when to stop.

    Raises:
        ValueError: a start or bounds that are not finite numbers in order.
    """
    lower, upper = (np.asarray(bound, float) for bound in bounds)
    start = np.asarray(start, float)
    if not (
        np.isfinite(start).all() and np.isfinite(lower).all() and np.isfinite(upper).all() and (lower <= upper).all()
    ):
        raise ValueError(f"start and bounds must be finite with lower <= upper, got {start}, {lower}, {upper}")
    found = residual(np.clip(start, lower, upper))
    room = room_for(len(start), len(found[0]))
    room.lower[:], room.upper[:] = lower, upper
    rules = Rules(*(float(rule) for rule in rules))
    begin(room, start, start)
    room.r_ahead[:], room.jacobian_ahead[:] = found
    while (status := advance(room, rules)) == GOING:
        room.r_ahead[:], room.jacobian_ahead[:] = residual(room.ahead.copy())
    return Solution(
        x=room.x.copy(),
        residual=float(np.linalg.norm(residual(room.x.copy())[0])),
        status=STATUS[status],
        iterations=int(room.numbers[TRIED]),
    )
