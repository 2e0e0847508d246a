"""Options of a tracking controller."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

LEAST, MOST = 1e-9, 1e9  # of what a filter's gains are made of [m, m/s^0.5, -]


@dataclass(frozen=True, kw_only=True)
class TrackingOptions:
    """Options of a tracking controller.

    Attributes:
        period: time between rows of the path, and between commands [s].
        distance: of the object [m]; infinite without one.
        density: of the rubber [kg/m^3]; by default that of the scene's [gravity].
        noise: standard deviation of the tip's readings [m].
        drift: standard deviation of the change of the model's error in a second [m/s^0.5].
        effort: weight of the square of a correction over that of the tip's error [-].
        correction: largest correction, as a displacement of the tip [m].
        pretension: share of the limits' range; the plan takes the tensions nearest to it [-].
        feel: contact force above which a reading counts as contact [N].
        most_force: largest planned contact force [N].
    """

    period: float = 1e-3
    distance: float = np.inf
    density: float | None = None
    noise: float = 2e-5
    drift: float = 3e-4
    effort: float = 3.0
    correction: float = 3e-3
    pretension: float = 0.05
    feel: float = 0.05
    most_force: float = np.inf

    def __post_init__(self) -> None:
        for name in ("noise", "drift", "effort"):
            if not LEAST <= getattr(self, name) <= MOST:
                raise ValueError(f"{name} must be from {LEAST:g} to {MOST:g}, got {getattr(self, name)}")
        for name in ("period", "correction", "feel"):
            if not 0 < getattr(self, name) < np.inf:
                raise ValueError(f"{name} must be finite and above 0, got {getattr(self, name)}")
        if not 0 <= self.pretension <= 1:
            raise ValueError(f"pretension must be from 0 to 1, got {self.pretension}")
        if not self.most_force > 0:
            raise ValueError(f"most_force must be above 0 N, got {self.most_force}")
