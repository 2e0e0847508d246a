"""Bounded Levenberg-Marquardt for a handful of unknowns: minimise |r(x)|^2 / 2 with lower <= x <= upper.

Damping by the gain ratio (Nielsen, IMM-REP-1999-05, DTU 1999); bounds by projection, with the variables that the
gradient pushes against their bound left out of the step. A step is a linear least-squares problem, solved by
Householder reflections (normal equations would square the condition). If many points solve the problem, as two
tensions hold one force, null-space motion goes on along them to the one nearest to the start (projected gradient of the
distance, the residual corrected at every step).

Compiled, and without allocation (control/native/least_squares.h).
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from control.native import CONTROL
from rom.brief import brief
from rom.native import pointer

STATUS = ("going", "converged", "stationary", "iteration_limit", "out_of_domain")
GOING, CONVERGED, STATIONARY, LIMIT, OUTSIDE = (
    getattr(CONTROL.constants, f"CONTROL_{name}")
    for name in ("GOING", "CONVERGED", "STATIONARY", "ITERATION_LIMIT", "OUTSIDE")
)


class Rules(NamedTuple):
    """When to stop.

    Attributes:
        residual: converged below this |r| (the residual's own unit).
        longest: most a step may change a variable, over the bounds' width [-]; far steps land in other valleys.
        step: stationary when a step below this, over the bounds' width, gains less than this, over the cost [-].
        nearest: of all solutions the nearest to the start is taken: along them, the start lies ahead by at most this
            share of its distance, over the bounds' width [-]; 1 takes any.
        null_space_iterations: most evaluations of that motion.
        iterations: most evaluations of the residual in all.
    """

    residual: float = 1e-6
    longest: float = 0.2
    step: float = 1e-9
    nearest: float = 1e-3
    null_space_iterations: int = 50
    iterations: int = 100


@cache
def struct(rules: Rules) -> Any:
    """The rules as a struct control_rules."""
    return CONTROL.struct("control_rules", **rules._asdict())


RULES = Rules()


@brief
@dataclass(frozen=True, kw_only=True)
class Solution:
    """Last point and reason to stop: "converged", "stationary" (a minimum above the tolerance) or "iteration_limit"."""

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
    start = np.ascontiguousarray(start, float)
    if not (
        np.isfinite(start).all() and np.isfinite(lower).all() and np.isfinite(upper).all() and (lower <= upper).all()
    ):
        raise ValueError(f"start and bounds must be finite with lower <= upper, got {start}, {lower}, {upper}")
    linear = residual(np.clip(start, lower, upper))
    lib, n, m = CONTROL.functions, len(start), len(linear[0])
    memory = np.empty(lib.control_workspace_size(n, m))
    workspace = CONTROL.ffi.new("control_workspace *")
    lib.control_workspace_in(workspace, n, m, pointer(memory))
    x, ahead, low, high, r, jacobian = (
        np.frombuffer(CONTROL.ffi.buffer(where, 8 * count))
        for where, count in (
            (workspace.x, n),
            (workspace.ahead, n),
            (workspace.lower, n),
            (workspace.upper, n),
            (workspace.r_ahead, m),
            (workspace.jacobian_ahead, m * n),
        )
    )
    low[:], high[:] = lower, upper
    lib.control_begin(workspace, pointer(start), pointer(start))
    r[:], jacobian[:] = linear[0], np.ravel(linear[1])
    while (status := lib.control_advance(workspace, struct(rules))) == GOING:
        linear = residual(ahead.copy())
        r[:], jacobian[:] = linear[0], np.ravel(linear[1])
    return Solution(
        x=x.copy(),
        residual=float(np.linalg.norm(residual(x.copy())[0])),
        status=STATUS[status],
        iterations=workspace.evaluations,
    )
