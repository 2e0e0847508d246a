"""The plane on which tensions press with forces that were felt, as a compiled problem of one variable."""

from __future__ import annotations

import math

import numpy as np

from control.least_squares import advance
from control.problems import Desk, Model, ask, desk_for, force_error
from control.room import CONVERGED, GOING, TRIED, Room, Rules, begin, room_for
from rom.compiled import compiled
from rom.kernel import FORCE, TOUCH


@compiled(allocates=True)
def locate_once(
    model: Model, tensions: np.ndarray, felt: np.ndarray, hint: float, rules: Rules
) -> tuple[int, float, float, int, float, float]:
    """See locate."""
    return locate(model, desk_for(model), room_for(1, len(felt)), tensions, felt, hint, rules)


@compiled
def locate(
    model: Model, desk: Desk, room: Room, tensions: np.ndarray, felt: np.ndarray, hint: float, rules: Rules
) -> tuple[int, float, float, int, float, float]:
    """Find the plane on which tensions, shape (m, tensions) [N], press with contact forces, shape (m,) [N].

    Begins at a hint [m], if that is a number; `room` is for one variable and m residuals.

    Returns:
        status, d [m], root mean square of contact force - felt [N] and evaluations; and there, with the derivatives s_i
        of the forces by d [N/m] and the model's errors e_i [N], sum s_i^2 and sum |s_i| e_i.
    """
    m, n = tensions.shape
    nearest, farthest = model.kernel.lower[n], model.kernel.upper[n]
    touched = nearest
    for i in range(m):
        ask(model, desk, tensions[i], np.inf)
        touched = max(touched, desk.out[TOUCH])
    room.lower[0], room.upper[0] = nearest, min(touched, farthest)
    status, tried, least, found = GOING, 0, math.inf, float(nearest)
    for way in (-1.0, 0.9, 0.5, 0.1):
        if way < 0.0 and not np.isfinite(hint):
            continue
        room.best[0] = hint if way < 0.0 else nearest + way * (room.upper[0] - nearest)
        begin(room, room.best, room.best)
        now = GOING
        while now == GOING:
            for i in range(m):
                ask(model, desk, tensions[i], room.ahead[0])
                room.r_ahead[i] = desk.out[FORCE] - felt[i]
                room.jacobian_ahead[i, 0] = desk.jacobian[FORCE, n]
            now = advance(room, rules)
        tried += m * int(room.numbers[TRIED])
        missed = 0.0
        for i in range(m):
            missed += room.r[i] ** 2
        if missed < least:
            status, least, found = now, missed, room.x[0]
        if now == CONVERGED:
            break
    steep, wrong = 0.0, 0.0
    for i in range(m):
        ask(model, desk, tensions[i], found)
        slope = desk.jacobian[FORCE, n]
        steep += slope**2
        wrong += abs(slope) * force_error(model, desk)
    return status, found, math.sqrt(least / m), tried, steep, wrong
