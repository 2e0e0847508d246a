"""Of the points that solve a least-squares problem the one nearest to home, by going on along them.

The way home is projected on the directions that leave the residual as it is, and the residual corrected at every step.
"""

from __future__ import annotations

import numpy as np

from control.householder import solve
from control.room import AWAY, CONVERGED, GOING, SHARE, SOLVED, TRIED, Room, Rules, accept, copy, largest, longest, look
from rom.compiled import compiled

LEAST_SHARE = 1 / 16
RANK = 1e-10  # share of the largest singular value, squared, below which a direction does not count


@compiled
def keep(room: Room) -> None:
    """Keep x, which solves the problem, if it is nearer to home than the best so far."""
    away = 0.0
    for j in range(len(room.x)):
        away += ((room.x[j] - room.home[j]) / room.width[j]) ** 2
    if away < room.numbers[AWAY]:
        room.numbers[AWAY] = away
        copy(room.x, room.best)


@compiled
def go_home(room: Room, rules: Rules, cost: float) -> int:
    """Go on from the point ahead, unless it is none."""
    if not np.isfinite(cost):
        return _settle(room)
    accept(room, cost)
    if np.sqrt(2.0 * cost) <= rules.residual:
        keep(room)
    return towards_home(room, rules)


@compiled
def towards_home(room: Room, rules: Rules) -> int:
    """Look nearer to home, with the residual corrected; CONVERGED where nothing is nearer."""
    n, m = len(room.x), len(room.r)
    tried = room.numbers[TRIED]
    if rules.nearest >= 1.0 or tried >= rules.iterations or tried - room.numbers[SOLVED] >= rules.homeward:
        return _settle(room)
    for j in range(n):
        room.free[j] = room.upper[j] > room.lower[j]
    damping = RANK * max(largest(room), 1e-300)
    copy(room.step, room.last)
    away = 0.0
    for _ in range(n):  # each time a variable is found that would leave its bound
        for j in range(n):
            way = (room.home[j] - room.x[j]) / room.width[j] if room.free[j] else 0.0
            room.back[j] = room.numbers[SHARE] * way
            away = max(away, abs(way))
        for i in range(m):
            room.right[i] = -room.r[i]
            for j in range(n):
                room.right[i] -= room.jacobian[i, j] * room.back[j]
        solve(room, damping)
        leaving = False
        for j in range(n):
            room.step[j] += room.back[j]
            down, up = room.x[j] <= room.lower[j], room.x[j] >= room.upper[j]
            if room.free[j] and ((down and room.step[j] < 0.0) or (up and room.step[j] > 0.0)):
                room.free[j], leaving = False, True
        if not leaving:
            break
    if longest(room.step) <= rules.nearest * room.numbers[SHARE] * away:
        return _settle(room)
    turned = 0.0
    for j in range(n):
        turned += room.step[j] * room.last[j]
    if turned < 0.0:  # a strongly curved surface: the whole way swings from side to side
        room.numbers[SHARE] = max(0.5 * room.numbers[SHARE], LEAST_SHARE)
    look(room, rules.longest)
    return GOING


@compiled
def _settle(room: Room) -> int:
    """Take the best as the answer."""
    copy(room.best, room.x)
    return CONVERGED
