"""Report of a finger besides its answer: the tip's orientation and the actuators' strokes, with derivatives."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rom.brief import brief
from rom.rod.compiled.evaluation import Evaluation
from rom.rod.compiled.reports import QUATERNION


@brief
class FingerReport(NamedTuple):
    """Report of a finger besides its answer at one point of p parameters, shapes without n, or at n points.

    Attributes:
        orientation: of the tip plate's frame, as a unit quaternion w, x, y, z with w >= 0, shape (n, 4) [-]; its sign
            changes where the tip has turned by half a turn.
        shortenings: how much shorter every tendon is between the clamp and its plate, shape (n, tendons) [m].
        orientation_jacobian: by loads and d, shape (n, 4, p) [1/N, 1/Pa, 1/m]; at fixed d what presses goes along.
        shortening_jacobian: likewise, shape (n, tendons, p) [m/N, m/Pa, -].
        orientation_error: estimated, an angle, shape (n,) [rad]; infinite without an equilibrium.
        shortening_error: estimated, of each, shape (n,) [m]; likewise.
        inside: as of an `Answer`, shape (n,).
        growths: how much larger every chamber is, shape (n, chambers) [m^3].
        growth_jacobian: likewise, shape (n, chambers, p) [m^3/N, m^3/Pa, m^2].
        growth_error: estimated, of each, shape (n,) [m^3]; infinite without an equilibrium.
    """

    orientation: np.ndarray
    shortenings: np.ndarray
    orientation_jacobian: np.ndarray
    shortening_jacobian: np.ndarray
    orientation_error: Any
    shortening_error: Any
    inside: Any
    growths: np.ndarray
    growth_jacobian: np.ndarray
    growth_error: Any

    @classmethod
    def of(cls, evaluation: Evaluation, tendons: int, growth_error: float) -> FingerReport:
        """Report from an evaluation by compiled code at n points.

        Args:
            evaluation: of a finger.
            tendons: how many it has; the other strokes are of chambers.
            growth_error: the expected one [m^3].
        """
        rows, jacobians, errors = evaluation.reports
        ends = [QUATERNION, QUATERNION + tendons]
        orientation, shortenings, growths = np.split(rows, ends, axis=1)
        by = np.split(jacobians, ends, axis=1)
        return cls(
            orientation=orientation,
            shortenings=shortenings,
            orientation_jacobian=by[0],
            shortening_jacobian=by[1],
            orientation_error=errors[:, 0],
            shortening_error=errors[:, 1],
            inside=evaluation.inside,
            growths=growths,
            growth_jacobian=by[2],
            growth_error=np.where(np.isinf(errors[:, 1]), np.inf, growth_error),
        )
