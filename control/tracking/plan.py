"""Planned tensions of a path: the static inverse of the model, corrected by damping and inertia of the finger."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from control.least_squares import Rules, minimise
from control.motion import Limits
from control.outcomes import listed
from control.tracking.linearised import PLANAR, Linearised
from control.tracking.options import TrackingOptions
from rom.brief import brief
from rom.rod.touched_segment import TouchedSegment

TOLERANCE = 1e-5  # largest distance of the tip from a row that counts as reached [m]
CHOICE = 1e-4  # weight of the distance from the pretension over the range: selects one of many solutions [m]
ROOM = 0.01  # distance of a tension from its limits, over their range, below which feedback does not use it [-]
RULES = Rules(residual=1e-9, longest=0.2, step=1e-5, nearest=1.0, null_space_iterations=0, iterations=40)


@brief
class Plan(NamedTuple):
    """A path of n rows.

    Attributes:
        tensions: at every row, shape (n, t) [N].
        tips: goals of the tip, y and z, shape (n, 2) [m]: the path, or the surface of an object in front of it.
        contact_forces: of the object at rest, shape (n,) [N].
        gains: derivatives of tensions by the position of the free tip, shape (n, t, 2) [N/m].
        motions: derivatives of the free tip by tensions, shape (n, 2, t) [m/N].
        shares: displacements of the free tip per relative change of load, and of inertia, shape (n, 2, 2) [m].
        reason: of a refused path, in one line; empty for an accepted path.
    """

    tensions: np.ndarray
    tips: np.ndarray
    contact_forces: np.ndarray
    gains: np.ndarray
    motions: np.ndarray
    shares: np.ndarray
    reason: str


def differences(path: np.ndarray, period: float) -> tuple[np.ndarray, np.ndarray]:
    """Velocities and accelerations at rows, shapes (n, 2) [m/s, m/s^2], of a path that starts at rest and continues."""
    longer = np.concatenate([path[:1], path, 2 * path[-1:] - path[-2:-1]])
    ahead, behind = longer[2:] - path, path - longer[:-2]
    return (ahead + behind) / (2 * period), (ahead - behind) / period**2


def planned(
    model: TouchedSegment, path: np.ndarray, system: Linearised | None, options: TrackingOptions, limits: Limits
) -> Plan:
    """Plan rows of y and z, shape (n, 2) [m]; without a linear system the plan is quasi-static."""
    t = len(model.rod.names)
    bounds = limits.within(*(end[:t] for end in model.limits))
    ahead = np.zeros_like(path)
    if system is not None:
        velocities, accelerations = differences(path, options.period)
        ahead = velocities @ system.damping.T + accelerations @ system.inertia.T
    goals = path + ahead
    tensions, missed = np.empty((len(path), t)), np.empty(len(path))
    start = pretension = _pretension(options.pretension, bounds)
    for k, goal in enumerate(goals):
        start, missed[k] = inverse(model, goal, start, pretension, bounds)
        tensions[k] = start
    free, pressed = (
        model.answers(np.column_stack([tensions, np.full(len(path), d)])) for d in (np.inf, options.distance)
    )
    motions = free.jacobians[:, 1:3, :t]
    room = np.minimum(tensions - bounds[0], bounds[1] - tensions) > ROOM * (bounds[1] - bounds[0])
    gains = np.linalg.pinv(motions * room[:, None], rcond=PLANAR)
    forces = pressed.out[:, 3]
    touching = forces > 0
    aside = np.where(touching[:, None], pressed.out[:, 1:3] + model.rod.rest[1:] - path, 0.0)
    normal = model.direction[1:]
    tips = path + np.outer(aside @ normal, normal) / max(float(normal @ normal), 1e-12)
    shares = np.stack([np.einsum("nkt,nt->nk", motions, tensions), ahead], axis=-1)
    change = limits.rate * options.period
    reason = _unreached(goals, missed, bounds) or _refused(tensions, forces, pressed.inside, change, options.most_force)
    return Plan(tensions, tips, forces, gains, motions, shares, reason)


def resting(
    model: TouchedSegment, goal: np.ndarray, pretension: float, bounds: tuple[np.ndarray, np.ndarray]
) -> np.ndarray:
    """Equilibrium tensions, shape (t,) [N], near a pretension [-], of the tip nearest to y and z, shape (2,) [m]."""
    pulled = _pretension(pretension, bounds)
    return inverse(model, goal, pulled, pulled, bounds)[0]


def _pretension(share: float, bounds: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    return np.asarray(bounds[0] + share * (bounds[1] - bounds[0]))


def inverse(
    model: TouchedSegment,
    goal: np.ndarray,
    start: np.ndarray,
    pretension: np.ndarray,
    bounds: tuple[np.ndarray, np.ndarray],
) -> tuple[np.ndarray, float]:
    """Equilibrium tensions, shape (t,) [N], of the free tip at y and z, shape (2,) [m]; the remaining distance [m]."""
    t = len(start)
    weight, away = CHOICE / np.maximum(bounds[1] - bounds[0], 1e-9), np.full(len(model.objects), np.inf)

    def residual(tensions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        value, jacobian = model.value_and_jacobian(np.append(tensions, away))
        off = np.concatenate([value[1:3] + model.rod.rest[1:] - goal, weight * (tensions - pretension)])
        return off, np.vstack([jacobian[1:3, :t], np.diag(weight)])

    found = minimise(residual, start, bounds, RULES)
    return found.x, float(np.linalg.norm(residual(found.x)[0][:2]))


def _unreached(goals: np.ndarray, missed: np.ndarray, bounds: tuple[np.ndarray, np.ndarray]) -> str:
    """Reason to refuse tensions that do not reach their goals, with the worst row; empty if they do."""
    k = int(np.argmax(missed))
    if missed[k] <= TOLERANCE:
        return ""
    within = f"tensions from {listed(bounds[0])} to {listed(bounds[1])} N"
    return (
        f"path row {k} must be reached with its inertia, at {listed(goals[k])} m, by {within}, got a distance of "
        f"{missed[k]:.3g} m: move or slow the path"
    )


def _refused(tensions: np.ndarray, forces: np.ndarray, inside: np.ndarray, change: float, most_force: float) -> str:
    """Return the reason to refuse tensions, with the worst row; empty if they are accepted."""
    if not inside.all():
        k = int(np.argmin(inside))
        return f"path row {k} must lie in the trained domain, got tensions {listed(tensions[k])} N: move the path"
    changes = np.abs(np.diff(tensions, axis=0)).max(axis=1)
    k = int(np.argmax(changes))
    if changes[k] > change:
        return (
            f"path row {k + 1} must be reached with limits.rate, by {change:g} N a period, but needs "
            f"{changes[k]:.3g} N: slow the path"
        )
    k = int(np.argmax(forces))
    if forces[k] > most_force:
        return f"path row {k} must press with at most {most_force:g} N, got {forces[k]:.3g} N: move the path away"
    return ""
