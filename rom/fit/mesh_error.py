"""What the mesh that a surrogate was trained on adds to its error, as states on a finer mesh told.

A coarse mesh is too stiff. It bends a finger by some share less, so that places err by a share of how far the tip has
gone; and a plane presses by a share more or less, and by what contact's stiffness makes of the place's error.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rom.native import answer

COVERAGE = 95  # percent of states whose error is to be at most the estimated one
NO_SHARES = 0.0, 0.0
PAST = 1e-6  # [m]: how far past touch contact's stiffness is asked for where it is not touched yet


@dataclass(frozen=True, kw_only=True)
class MeshError:
    """Shares that make an estimate of what a mesh adds to errors.

    Attributes:
        tip: of the tip's distance from where it rests [-].
        touch_distance: likewise [-].
        displacement: likewise, for the root mean square over the nodes [-].
        contact_force: of the force; and of the tip's distance from where it rests, times contact's stiffness [-].
        pad_pressure: likewise, of the pressure [-].
    """

    tip: float
    touch_distance: float
    displacement: float
    contact_force: tuple[float, float] = NO_SHARES
    pad_pressure: tuple[float, float] = NO_SHARES

    def of(self, kernel: Any, points: np.ndarray, out: np.ndarray) -> dict[str, np.ndarray]:
        """Estimates by quantity, each of shape (n,), in its unit [m, N, Pa].

        Args:
            kernel: a struct fingerfem_kernel.
            points: shape (n, p).
            out: its answers there, shape (n, m).
        """
        size = np.linalg.norm(out[:, :3], axis=1)
        found = {name: getattr(self, name) * size for name in ("tip", "touch_distance", "displacement")}
        if not kernel.has_obstacle:
            return found | {"contact_force": np.zeros(len(size))}
        rows = {"contact_force": answer.FORCE} | ({"pad_pressure": answer.PAD} if kernel.has_pad else {})
        for name, row in rows.items():
            share, place = getattr(self, name)
            found[name] = share * out[:, row] + place_errors(kernel, points, out, row, place * size)
        return found


def place_errors(kernel: Any, points: np.ndarray, out: np.ndarray, row: int, shifts: np.ndarray) -> np.ndarray:
    """By how much a row of answers changes if the finger stands off by shifts, shape (n,) [m]; shape (n,) [N, Pa].

    Where the plane is not touched, but would be by less than the shift, it is what the rest of that makes.
    """
    gaps = points[:, -1] - out[:, answer.TOUCH]
    near = gaps < shifts
    past = points[near].copy()
    past[:, -1] = np.minimum(past[:, -1], out[near, answer.TOUCH] - PAST)
    found = np.zeros(len(points))
    left = shifts[near] - np.maximum(gaps[near], 0.0)
    found[near] = left * np.abs(answer.slopes_by_distance(kernel, past, row))
    return found


def covering(errors: np.ndarray) -> float:
    """The smallest of these, shape (n,), that covers a further one of their kind with 95 % probability (conformal).

    Of n fewer than 19 none does: the largest covers it with the probability n / (n + 1).
    """
    if not len(errors):
        return 0.0
    rank = int(np.ceil((len(errors) + 1) * COVERAGE / 100))
    return float(np.sort(errors)[min(rank, len(errors)) - 1])
