"""A least-squares problem while it is solved: rules, room to work in, and what every step needs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rom.compiled import compiled

GOING, CONVERGED, STATIONARY, LIMIT = range(4)
STATUS = ("going", "converged", "stationary", "iteration_limit")
COST, DAMPING, GROWTH, TRIED, SOLVED, AWAY, SHARE = range(7)  # of Room.numbers


class Rules(NamedTuple):
    """When to stop.

    Attributes:
        residual: converged below this |r| (the residual's own unit).
        longest: most a step may change a variable, over the bounds' width [-]; far steps land in other valleys.
        step: stationary when a step below this, over the bounds' width, gains less than this, over the cost [-].
        nearest: of all solutions the nearest to home is taken: along them, home lies ahead by at most this share of its
            distance, over the bounds' width [-]; 1 takes any.
        homeward: most evaluations on the way to it.
        iterations: most evaluations of the residual in all.
    """

    residual: float = 1e-6
    longest: float = 0.2
    step: float = 1e-9
    nearest: float = 1e-3
    homeward: float = 50.0
    iterations: float = 100.0


class Room(NamedTuple):
    """A problem of n variables and at most m residuals while it is solved; rows that are not used are zero.

    Attributes:
        x: the point so far, shape (n,).
        ahead: where the residual is asked for, shape (n,).
        home: the nearest to it is wanted of many solutions, shape (n,).
        best: of the points that solve the problem the nearest to home, shape (n,).
        lower, upper, width: bounds, shapes (n,).
        r, jacobian: at x, the jacobian by variables over the bounds' width, shapes (m,), (m, n).
        r_ahead, jacobian_ahead: to be written by whoever calls.
        step, last, back: over the bounds' width: the step, the one before, the way home, shapes (n,).
        free: which variables the step may change, shape (n,).
        system, right: of the step's least-squares problem, shapes (m + n, n), (m + n,).
        numbers: cost, damping, its growth, evaluations, evaluations until it was solved, distance of `best` from home,
            share of the way home that is tried at once.
    """

    x: np.ndarray
    ahead: np.ndarray
    home: np.ndarray
    best: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    width: np.ndarray
    r: np.ndarray
    jacobian: np.ndarray
    r_ahead: np.ndarray
    jacobian_ahead: np.ndarray
    step: np.ndarray
    last: np.ndarray
    back: np.ndarray
    free: np.ndarray
    system: np.ndarray
    right: np.ndarray
    numbers: np.ndarray


@compiled(allocates=True)
def room_for(n: int, m: int) -> Room:
    """Room for problems of n variables and at most m residuals."""
    return Room(
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.ones(n),
        np.zeros(m),
        np.zeros((m, n)),
        np.zeros(m),
        np.zeros((m, n)),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.ones(n, np.bool_),
        np.zeros((m + n, n)),
        np.zeros(m + n),
        np.zeros(7),
    )


@compiled
def begin(room: Room, start: np.ndarray, home: np.ndarray) -> None:
    """Put a start where the residual is asked for first; of many solutions the nearest to home is wanted.

    Both are moved into the bounds, which must be in the room.
    """
    for j in range(len(start)):
        room.width[j] = room.upper[j] - room.lower[j] if room.upper[j] > room.lower[j] else 1.0
        room.ahead[j] = min(max(start[j], room.lower[j]), room.upper[j])
        room.home[j] = min(max(home[j], room.lower[j]), room.upper[j])
    room.numbers[:] = 0.0
    room.numbers[COST], room.numbers[DAMPING], room.numbers[GROWTH] = np.inf, -1.0, 2.0
    room.numbers[AWAY] = np.inf
    room.r_ahead[:] = 0.0
    room.jacobian_ahead[:] = 0.0


@compiled
def accept(room: Room, cost: float) -> None:
    """Make the point ahead the one to go on from."""
    n, m = len(room.x), len(room.r)
    room.numbers[COST] = cost
    for j in range(n):
        room.x[j] = room.ahead[j]
    for i in range(m):
        room.r[i] = room.r_ahead[i]
        for j in range(n):
            room.jacobian[i, j] = room.jacobian_ahead[i, j] * room.width[j]


@compiled
def copy(source: np.ndarray, target: np.ndarray) -> None:
    """Write an array, shape (n,), into another."""
    for j in range(len(source)):
        target[j] = source[j]


@compiled
def longest(step: np.ndarray) -> float:
    """The largest change of a variable, over the bounds' width."""
    found = 0.0
    for j in range(len(step)):
        found = max(found, abs(step[j]))
    return found


@compiled
def largest(room: Room) -> float:
    """The largest column's square."""
    found = 0.0
    for j in range(len(room.x)):
        size = 0.0
        for i in range(len(room.r)):
            size += room.jacobian[i, j] ** 2
        found = max(found, size)
    return found


@compiled
def look(room: Room, most: float) -> None:
    """Write the point ahead: a step on, of at most this length, within the bounds; and the step that this is."""
    shrink = min(1.0, most / max(longest(room.step), 1e-300))
    for j in range(len(room.x)):
        wanted = room.x[j] + shrink * room.step[j] * room.width[j]
        room.ahead[j] = min(max(wanted, room.lower[j]), room.upper[j])
        room.step[j] = (room.ahead[j] - room.x[j]) / room.width[j]
