"""Bounded Levenberg-Marquardt for a handful of unknowns: minimise |r(x)|^2 / 2 with lower <= x <= upper.

Damping by the gain ratio (Nielsen, IMM-REP-1999-05, DTU 1999); bounds by projection, with the variables that the
gradient pushes against their bound left out of the step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True)
class Options:
    """When to stop.

    Attributes:
        residual: converged below this |r| (the residual's own unit).
        longest: most a step may change a variable, over the bounds' width [-]; far steps land in other valleys.
        step: stationary when a step below this, over the bounds' width, gains less than this, over the cost [-].
        iterations: most evaluations of the residual.
    """

    residual: float = 1e-6
    longest: float = 0.2
    step: float = 1e-9
    iterations: int = 100


@dataclass(frozen=True, kw_only=True)
class Solution:
    """Where it stopped and why: "converged", "stationary" (a minimum above the tolerance) or "iteration_limit"."""

    x: np.ndarray
    residual: float
    status: str
    iterations: int


Residual = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


def minimise(
    residual: Residual, start: np.ndarray, bounds: tuple[np.ndarray, np.ndarray], options: Options
) -> Solution:
    """Find the least residual from a start.

    Args:
        residual: x, shape (n,), to r, shape (m,), and dr/dx, shape (m, n).
        start: shape (n,); moved into the bounds.
        bounds: lower and upper, shapes (n,); equal where a variable is fixed.
        options: when to stop.

    Raises:
        ValueError: a start or bounds that are not finite numbers in order.
    """
    lower, upper = bounds
    if not (
        np.isfinite(start).all() and np.isfinite(lower).all() and np.isfinite(upper).all() and (lower <= upper).all()
    ):
        raise ValueError(f"start and bounds must be finite with lower <= upper, got {start}, {lower}, {upper}")
    width = np.where(upper > lower, upper - lower, 1.0)
    x = np.minimum(np.maximum(start, lower), upper)
    r, jacobian = residual(x)
    cost = 0.5 * float(r @ r)
    damping, growth, tried = -1.0, 2.0, 1
    while True:
        norm = float(np.sqrt(2 * cost))
        if norm <= options.residual:
            return Solution(x=x, residual=norm, status="converged", iterations=tried)
        if tried >= options.iterations:
            return Solution(x=x, residual=norm, status="iteration_limit", iterations=tried)
        scaled = jacobian * width
        gradient = scaled.T @ r
        free = ~(((x <= lower) & (gradient >= 0)) | ((x >= upper) & (gradient <= 0)))
        if not free.any() or np.abs(gradient[free]).max() <= 1e-14 * max(norm, 1e-300):
            return Solution(x=x, residual=norm, status="stationary", iterations=tried)
        normal = scaled.T @ scaled
        if damping < 0:
            damping = 1e-4 * float(np.diag(normal).max())
        step = np.zeros_like(x)
        some = np.flatnonzero(free)
        step[some] = -np.linalg.solve(normal[np.ix_(some, some)] + damping * np.eye(len(some)), gradient[some])
        step *= min(1.0, options.longest / max(float(np.abs(step).max()), 1e-300))
        ahead = np.minimum(np.maximum(x + step * width, lower), upper)
        step = (ahead - x) / width
        r_ahead, jacobian_ahead = residual(ahead)
        tried += 1
        cost_ahead = 0.5 * float(r_ahead @ r_ahead)
        model = r + scaled @ step
        expected = cost - 0.5 * float(model @ model)
        gain = (cost - cost_ahead) / expected if expected > 0 else -1.0
        small = float(np.abs(step).max()) <= options.step
        if cost_ahead < cost and np.isfinite(cost_ahead):
            settled = small and cost - cost_ahead <= options.step * cost
            x, r, jacobian, cost = ahead, r_ahead, jacobian_ahead, cost_ahead
            damping *= max(0.1, 1 - (2 * gain - 1) ** 3)
            growth = 2.0
        else:
            settled = small
            damping *= growth
            growth *= 2.0
        if settled and cost > 0.5 * options.residual**2:
            return Solution(x=x, residual=float(np.sqrt(2 * cost)), status="stationary", iterations=tried)
