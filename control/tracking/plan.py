"""Planned tensions of a path: the inverse of the model at rest, corrected by damping and inertia of the finger."""

from typing import NamedTuple

import numpy as np

from control.motion import Limits
from control.outcomes import listed
from control.tracking.inverse import Bounds, inverses, pretensioned
from control.tracking.linearised import PLANAR, Linearised
from control.tracking.options import TrackingOptions
from control.tracking.surface import projected
from rom.brief import brief
from rom.rod.compiled.touched import Touched
from rom.rod.touched_segment import TouchedSegment

TOLERANCE = 1e-5  # largest distance of the tip from a row that counts as reached [m]
ROOM = 0.01  # distance of a tension from its limits, over their range, below which feedback does not use it [-]


@brief
class Plan(NamedTuple):
    """A path of n rows.

    Attributes:
        tensions: of the motors at every row, shape (n, t) [N].
        tips: the path, or the object's surface in front of it, y and z, shape (n, 2) [m].
        goals: the same with a slow approach to the surface, which feedback follows, shape (n, 2) [m].
        contact_forces: of the object, at rest or as means since the row before, shape (n,) [N].
        most_force: largest one, in simulated motion also of objects nearer and farther by `margin` of the options [N].
        stiffness: derivatives of these forces by the position of the free tip, shape (n, 2) [N/m].
        gains: derivatives of tensions by the position of the free tip, shape (n, t, 2) [N/m].
        motions: derivatives of the free tip by tensions, shape (n, 2, t) [m/N].
        shares: displacements of the free tip per relative change of load, and of inertia, shape (n, 2, 2) [m].
        reason: of a refused path, in one line; empty for an accepted path.
    """

    tensions: np.ndarray
    tips: np.ndarray
    goals: np.ndarray
    contact_forces: np.ndarray
    most_force: float
    stiffness: np.ndarray
    gains: np.ndarray
    motions: np.ndarray
    shares: np.ndarray
    reason: str

    @property
    def deviation(self) -> float:
        """Largest distance of the goals from the tips [m]."""
        return float(np.linalg.norm(self.goals - self.tips, axis=1).max())


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
    pretension = pretensioned(options.pretension, bounds)
    free_path = projected(model, path, pretension, bounds, options)
    ahead = np.zeros_like(path)
    if system is not None:
        velocities, accelerations = differences(free_path.approached, options.period)
        ahead = velocities @ system.damping.T + accelerations @ system.inertia.T
    goals = free_path.approached + free_path.pressed + ahead
    tensions = inverses(model, goals, pretension, bounds)
    free, pressed = (_answers(model, tensions, distance) for distance in (np.inf, options.distance))
    missed = np.linalg.norm(free.out[:, 1:3] + model.rod.rest[1:] - goals, axis=1)
    motions = free.jacobians[:, 1:3, :t]
    room = np.minimum(tensions - bounds[0], bounds[1] - tensions) > ROOM * (bounds[1] - bounds[0])
    gains = np.linalg.pinv(motions * room[:, None], rcond=PLANAR)
    forces = pressed.out[:, 3]
    stiffness = np.einsum("nt,ntk->nk", pressed.jacobians[:, 3, :t], gains)
    shares = np.stack([np.einsum("nkt,nt->nk", motions, tensions), ahead], axis=-1)
    plan = Plan(
        tensions=tensions,
        tips=free_path.tips,
        goals=free_path.approached,
        contact_forces=forces,
        most_force=float(forces.max()),
        stiffness=stiffness,
        gains=gains,
        motions=motions,
        shares=shares,
        reason=_unreached(goals, missed, bounds) or _outside(tensions, pressed.inside),
    )
    return plan if plan.reason else plan._replace(reason=refused(plan, options, limits))


def passing(plan: Plan, path: np.ndarray) -> list[int]:
    """Return the first rows of every stretch of a path behind the object's surface in which the plan has no contact."""
    behind = (plan.tips != path).any(axis=1)
    first = np.flatnonzero(behind & ~np.append(False, behind[:-1])).tolist()
    ends = [*first, len(path)][1:]
    return [row for row, end in zip(first, ends, strict=True) if not plan.contact_forces[row:end].any()]


def _answers(model: TouchedSegment, tensions: np.ndarray, distance: float) -> Touched:
    return model.answers(np.column_stack([tensions, np.full(len(tensions), distance)]))


def _unreached(goals: np.ndarray, missed: np.ndarray, bounds: Bounds) -> str:
    """Reason to refuse tensions that do not reach their goals, with the worst row; empty if they do."""
    k = int(np.argmax(missed))
    if missed[k] <= TOLERANCE:
        return ""
    within = f"tensions from {listed(bounds[0])} to {listed(bounds[1])} N"
    return (
        f"path row {k} must be reached with its inertia, at {listed(goals[k])} m, by {within}, got a distance of "
        f"{missed[k]:.3g} m: move or slow the path"
    )


def _outside(tensions: np.ndarray, inside: np.ndarray) -> str:
    """Reason to refuse tensions out of the trained domain, with the first row; empty if all are inside."""
    k = int(np.argmin(inside))
    if inside[k]:
        return ""
    return f"path row {k} must lie in the trained domain, got tensions {listed(tensions[k])} N: move the path"


def refused(plan: Plan, options: TrackingOptions, limits: Limits) -> str:
    """Return the reason to refuse a plan's rate of tensions, deviation or force; empty if they are accepted."""
    changes, change = np.abs(np.diff(plan.tensions, axis=0)).max(axis=1), limits.rate * options.period
    k = int(np.argmax(changes))
    if changes[k] > change:
        return (
            f"path row {k + 1} must be reached with limits.rate, by {change:g} N a period, but needs "
            f"{changes[k]:.3g} N: slow the path"
        )
    if plan.deviation > options.correction:
        k = int(np.argmax(np.linalg.norm(plan.goals - plan.tips, axis=1)))
        return (
            f"path row {k} must be followed within options.correction, {options.correction:g} m, got a simulated "
            f"distance of {plan.deviation:.3g} m: slow or smooth the path"
        )
    if plan.most_force > options.most_force:
        return (
            f"path must press with at most {options.most_force:g} N, also on an object nearer or farther by "
            f"{options.margin:g} m, got {plan.most_force:.3g} N: slow the path, or reduce options.margin"
        )
    return ""
