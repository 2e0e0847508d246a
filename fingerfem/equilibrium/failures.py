"""What is raised instead of a state that has not converged."""

from __future__ import annotations

import numpy as np


class NotConverged(Exception):
    """An attempt that found no equilibrium; the model's displacement is then what it was before."""

    def __init__(self, reason: str, iterations: int = 0):
        super().__init__(reason)
        self.reason, self.iterations = reason, iterations


class LoadNotReached(Exception):
    """Continuation stopped short; `tensions` [N] and `distance` [m] are the last load with an equilibrium."""

    def __init__(self, reason: str, tensions: np.ndarray, distance: float | None):
        where = f"tensions {np.round(tensions, 6).tolist()} N" + (
            f", d {distance:.6g} m" if distance is not None else ""
        )
        super().__init__(f"no equilibrium beyond {where}: {reason}")
        self.reason, self.tensions, self.distance = reason, tensions, distance
