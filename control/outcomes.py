"""Motions by what came of a question, or why it is refused: in sentences that name argument, value and range."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from control.least_squares import CONVERGED, LIMIT, OUTSIDE, STATIONARY
from control.motion import Motion

STATUSES = {CONVERGED: "converged", LIMIT: "iteration_limit", OUTSIDE: "out_of_domain"}
FARTHEST = 1e6  # of a point that can be asked for [m]


def listed(values: ArrayLike) -> str:
    """Numbers for a sentence."""
    numbers = np.asarray(values, float)
    return f"{numbers:g}" if numbers.ndim == 0 else "[" + ", ".join(f"{one:g}" for one in numbers.ravel()) + "]"


def beyond(name: str, value: ArrayLike, lower: ArrayLike, upper: ArrayLike, unit: str) -> str:
    """Why a value is refused; empty if all of it lies from `lower` to `upper`."""
    values = np.asarray(value, float)
    if values.size and np.all((values >= lower) & (values <= upper)):
        return ""
    return f"{name} must be from {listed(lower)} to {listed(upper)} {unit}, got {listed(values)} {unit}"


def not_positive(name: str, value: ArrayLike, unit: str) -> str:
    """Why a value is refused; empty if it is finite and above 0."""
    values = np.asarray(value, float)
    if values.size and np.all((values > 0) & (values < np.inf)):
        return ""
    return f"{name} must be finite and above 0 {unit}, got {listed(values)} {unit}"


def not_finite(name: str, value: ArrayLike, unit: str) -> str:
    """Why a value is refused; empty if it is finite."""
    if np.isfinite(value).all():
        return ""
    return f"{name} must be finite in {unit}, got {listed(value)} {unit}"


def no_point(value: np.ndarray) -> str:
    """Why a point is refused; empty if it is one that can be asked for."""
    if value.shape == (3,) and np.all(np.abs(value) < FARTHEST):
        return ""
    return f"point must be three numbers within {FARTHEST:g} m, got {listed(value)} of shape {value.shape}"


def unanswered(
    status: int,
    asked: str,
    limits: tuple[np.ndarray, np.ndarray],
    missed: str,
    evaluations: int,
    pressures: int = 0,
) -> str:
    """Why a solve has no answer, by its status; empty if it has one.

    Args:
        status: of the solve, see control.least_squares.
        asked: the argument and its value.
        limits: lower and upper of the tensions and pressures, shapes (loads,) [N, Pa].
        missed: how far the nearest answer is from the target, with its unit.
        evaluations: that the solve took.
        pressures: how many of the loads are pressures.
    """
    within = f"{'tensions and pressures' if pressures else 'tensions'} from {listed(limits[0])} to {listed(limits[1])}"
    within += " N, Pa" if pressures else " N"
    if status == STATIONARY:
        return f"{asked} must be met by {within}, the nearest of which miss it by {missed}"
    if status == OUTSIDE:
        return f"{asked} must be met within the trained domain, but the nearest answer by {within} is outside it"
    if status == LIMIT:
        return f"{asked} was not met by {evaluations} evaluations: begin from another start"
    return ""


def answered(
    status: int, tensions: np.ndarray, found: Any, asked: str, limits: tuple[np.ndarray, np.ndarray], **details: Any
) -> Motion:
    """The motion of a solve.

    Args:
        status: of it.
        tensions: that it found, shape (tensions,) [N].
        found: its outcome, a struct control_outcome.
        asked: the argument and its value.
        limits: lower and upper of the tensions, shapes (tensions,) [N].
        details: the other fields of the motion.
    """
    residual, evaluations = float(found.residual), int(found.evaluations)
    plain: dict[str, Any] = {
        name: value if name in ("sides", "unit", "pressures") else float(value) for name, value in details.items()
    }
    return Motion(
        tensions=tensions,
        status=STATUSES.get(status, "unreachable"),
        residual=residual,
        iterations=evaluations,
        reason=unanswered(
            status,
            asked,
            limits,
            f"{residual:.3g} {details.get('unit', 'N')}",
            evaluations,
            details.get("pressures", 0),
        ),
        **plain,
    )


def refused(tensions: np.ndarray, distance: float, reason: str, sides: tuple[int, int], pressures: int = 0) -> Motion:
    """No motion: the tensions stay."""
    return Motion(
        tensions=tensions,
        distance=float(distance),
        status="out_of_domain",
        residual=np.inf,
        error=np.nan,
        iterations=0,
        sides=sides,
        reason=reason,
        pressures=pressures,
    )
