"""What a finger reports besides its answer: the tip's orientation and the tendons' shortenings, with derivatives."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rom.brief import brief
from rom.rod.compiled.evaluation import Evaluation
from rom.rod.compiled.reports import QUATERNION


@brief
class FingerReport(NamedTuple):
    """What a finger reports besides its answer at one point of p parameters, shapes without n, or at n points.

    Attributes:
        orientation: of the tip plate's frame, as a unit quaternion w, x, y, z with w >= 0, shape (n, 4) [-]; its sign
            changes where the tip has turned by half a turn.
        shortenings: how much shorter every tendon is between the clamp and its plate, shape (n, t) [m].
        orientation_jacobian: by tensions and d, shape (n, 4, p) [1/N, 1/m]; at fixed d what presses goes along.
        shortening_jacobian: likewise, shape (n, t, p) [m/N, -].
        orientation_error: estimated, an angle, shape (n,) [rad]; infinite without an equilibrium.
        shortening_error: estimated, of each, shape (n,) [m]; likewise.
        inside: as of an `Answer`, shape (n,).
    """

    orientation: np.ndarray
    shortenings: np.ndarray
    orientation_jacobian: np.ndarray
    shortening_jacobian: np.ndarray
    orientation_error: Any
    shortening_error: Any
    inside: Any

    @classmethod
    def of(cls, evaluation: Evaluation) -> FingerReport:
        """Of what compiled code has computed at n points."""
        rows, jacobians, errors = evaluation.reports
        return cls(
            orientation=rows[:, :QUATERNION],
            shortenings=rows[:, QUATERNION:],
            orientation_jacobian=jacobians[:, :QUATERNION],
            shortening_jacobian=jacobians[:, QUATERNION:],
            orientation_error=errors[:, 0],
            shortening_error=errors[:, 1],
            inside=evaluation.inside,
        )
