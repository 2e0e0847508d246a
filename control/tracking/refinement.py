"""Refinement of a plan: the model's motion by the planned tensions is simulated, and its errors correct the plan.

This is iterative learning control on the model (Bristow, Tharayil and Alleyne, IEEE Control Systems 26-3, 2006). The
learning filter is an optimal control of the linear model, see `control.tracking.regulator`.
"""

from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from control.outcomes import listed
from control.tracking.inverse import Bounds
from control.tracking.linearised import SUBSTEP, Linearised
from control.tracking.options import TrackingOptions
from control.tracking.plan import Plan
from control.tracking.regulator import inputs
from rom.brief import brief
from rom.rod.motion.moving_finger import MovingFinger
from rom.rod.touched_segment import TouchedSegment

REFINEMENTS = 6  # largest number
SMALLER = 0.9  # largest mean square after a refinement over that before, to go on [-]
EFFORT = 0.1  # weight of the square of a correction over that of an error; less diverges by modes beyond the filter [-]


@brief
class Simulated(NamedTuple):
    """Motion of the model at n rows; nan after it leaves its domain.

    Attributes:
        tips: y and z, shape (n, 2) [m].
        contact_forces: mean since the row before, shape (n,) [N].
    """

    tips: np.ndarray
    contact_forces: np.ndarray


def refined(plan: Plan, model: TouchedSegment, system: Linearised, options: TrackingOptions, bounds: Bounds) -> Plan:
    """Return the plan with the least mean square of simulated errors, and its simulated tips and contact forces.

    Plans with allowed forces come before others. A plan whose first simulation leaves the trained domain gets a reason
    to refuse it.
    """
    least, best, tensions = np.inf, plan, plan.tensions
    for _ in range(1 + REFINEMENTS):
        found = simulated(model, tensions, options)
        errors = plan.goals - found.tips
        size = float((errors**2).mean())
        if not size < SMALLER * least:  # also without a simulated motion
            break
        least, most = size, _most_force(model, tensions, found, options)
        if best is plan or best.most_force > options.most_force or most <= options.most_force:
            best = plan._replace(
                tensions=tensions, goals=found.tips, contact_forces=found.contact_forces, most_force=most
            )
        corrections = inputs(system, errors, EFFORT)
        corrections[0] = 0.0  # where it begins at rest
        tensions = np.clip(tensions + np.einsum("ntk,nk->nt", plan.gains, corrections), *bounds)
    if least == np.inf:
        row = int(np.argmax(np.isnan(found.tips[:, 0])))
        what = f"path row {row} must lie in the trained domain in motion"
        return plan._replace(reason=f"{what}, got tensions {listed(plan.tensions[row])} N: slow the path")
    return best


def _most_force(model: TouchedSegment, tensions: np.ndarray, found: Simulated, options: TrackingOptions) -> float:
    """Largest simulated force [N], also of objects nearer and farther by the margin; infinite out of the domain."""
    most = float(found.contact_forces.max())
    if options.distance == np.inf or options.margin == 0 or not most <= options.most_force < np.inf:
        return most
    for change in (-options.margin, options.margin):
        moved = simulated(model, tensions, replace(options, distance=options.distance + change))
        most = max(most, np.inf if np.isnan(moved.tips).any() else float(moved.contact_forces.max()))
    return most


def simulated(model: TouchedSegment, tensions: np.ndarray, options: TrackingOptions) -> Simulated:
    """Simulate the model's motion by tensions at rows, shape (n, t) [N], which change linearly between them."""
    finger = MovingFinger(model, np.append(tensions[0], options.distance), options.density)
    n, steps = len(tensions), int(np.ceil(options.period / SUBSTEP - 1e-9))
    tips, forces = np.full((n, 2), np.nan), np.zeros((n, steps))
    tips[0] = model.outputs(np.append(tensions[0], options.distance)[None])[0, 1:3]
    for row, (begun, goal) in enumerate(pairwise(tensions), 1):
        for k in range(steps):
            now = begun + (k + 1) / steps * (goal - begun)
            state = finger.step(np.append(now, options.distance), options.period / steps)
            if state.status != "converged":
                return Simulated(tips + model.rod.rest[1:], forces.mean(axis=1))
            forces[row, k] = state.contact_forces[0]
        tips[row] = state.tip[1:]
    return Simulated(tips + model.rod.rest[1:], forces.mean(axis=1))
