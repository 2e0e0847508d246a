"""Exceptions for states that have not converged."""

import numpy as np

CRUSHING = 0.25  # tensions over Young's modulus times area, above which they are reported as too high [-]


class NotConverged(Exception):
    """An attempt that found no equilibrium; the model's displacement is then what it was before."""

    def __init__(self, reason: str, iterations: int = 0):
        super().__init__(reason)
        self.reason, self.iterations = reason, iterations


class BeyondLaw(NotConverged):
    """An equilibrium was found, but at stretches where the law of its material has no answer."""


class LoadNotReached(Exception):
    """Continuation stopped short of a load.

    Args:
        reason: why.
        tensions: of the last load with an equilibrium [N], then its pressures [Pa], shape (actuators,).
        distance: of that load [m].
        chambers: how many of the actuators are pressures.
        compression: sum of these tensions, over Young's modulus times the least area of a section [-].
    """

    def __init__(
        self, reason: str, tensions: np.ndarray, distance: float | None, chambers: int = 0, compression: float = 0.0
    ):
        tendons = len(tensions) - chambers
        where = f"tensions {np.round(tensions[:tendons], 6).tolist()} N"
        if compression > CRUSHING:
            where += f" ({compression:.0%} of Young's modulus times area: take lower tensions or stiffer rubber)"
        where += f", pressures {np.round(tensions[tendons:], 3).tolist()} Pa" if chambers else ""
        where += f", d {distance:.6g} m" if distance is not None else ""
        super().__init__(f"no equilibrium beyond {where}: {reason}")
        self.reason, self.tensions, self.distance = reason, tensions, distance
        self.reached = {"tensions": tensions[:tendons].tolist(), "distance": distance}  # for `solve --json`
        if chambers:
            self.reached["pressures"] = tensions[tendons:].tolist()
