"""Noise of the measurements behind a felt contact, and the estimate."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import chdtri

from control.finger import NORMAL_95
from control.outcomes import not_positive
from rom.brief import brief

UNUSUAL = 0.01  # of states that fit their noise, the share that counts as inconsistent [-]


@cache
def usual(freedom: int) -> float:
    """Chi_square that a share UNUSUAL of consistent measurements exceeds."""
    return float(chdtri(max(freedom, 1), UNUSUAL))


@brief
@dataclass(frozen=True, kw_only=True)
class Noise:
    """Standard deviations of the measurements; one for all tendons, or shape (tensions,).

    Attributes:
        shortening: [m].
        tension: [N].
        share: of the tension, added to `tension` as independent noise [-].
    """

    shortening: ArrayLike
    tension: ArrayLike
    share: ArrayLike = 0.0

    def deviations(self, tensions: np.ndarray, model_error: float) -> tuple[np.ndarray, np.ndarray]:
        """Those of tensions [N] and shortenings [m], shapes (t,); the model's own error [m] counts as noise.

        Raises:
            ValueError: a deviation that is not finite and above 0.
        """
        t = len(tensions)
        pulled = np.hypot(self.tension, np.multiply(self.share, np.abs(tensions)))
        shorter = np.hypot(self.shortening, model_error / NORMAL_95)
        for name, one, unit in (("tension", pulled, "N"), ("shortening", shorter, "m")):
            reason = not_positive(f"deviation of the {name}", one, unit)
            if reason:
                raise ValueError(reason)
        return np.broadcast_to(pulled, t).astype(float), np.broadcast_to(shorter, t).astype(float)


@brief
@dataclass(frozen=True, kw_only=True)
class Felt:
    """A contact that was felt: k unknowns of a finger with t tendons and, if objects are known, m of these.

    Attributes:
        names: of the unknowns.
        values: estimates of the unknowns, shape (k,), in their own units.
        covariance: of these, shape (k, k), by the measurements and what was expected.
        contact_forces: of the objects, shape (m,) [N]; empty where the force itself is unknown.
        force_covariance: of these, shape (m, m) [N^2].
        tensions: estimated, shape (t,) [N].
        unseen: directions of the unknowns, in their own units, shape (u, k). One standard deviation of the
            expectation along such a direction changes the measurements by less than their noise.
        chi_square: sum of squares of the measurements' deviations, over their standard deviations [-].
        freedom: measurements beyond the unknowns that are seen: the expected chi_square.
        status: converged, iteration_limit, or out_of_domain: the model is not trained there or has no equilibrium.
        iterations: evaluations of the model.
        other: unknowns of another contact that fits the measurements too, shape (k,); None if none was found. Several
            starts are tried; with a hint, only if the contact near it is not consistent.
        reason: why it is not converged; empty if it is.
    """

    names: tuple[str, ...]
    values: np.ndarray
    covariance: np.ndarray
    contact_forces: np.ndarray
    force_covariance: np.ndarray
    tensions: np.ndarray
    unseen: np.ndarray
    chi_square: float
    freedom: int
    status: str
    iterations: int
    other: np.ndarray | None = None
    reason: str = ""

    @property
    def converged(self) -> bool:
        """True if the values are an estimate."""
        return self.status == "converged"

    @property
    def deviations(self) -> np.ndarray:
        """Standard deviations of the unknowns, shape (k,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def force_deviations(self) -> np.ndarray:
        """Standard deviations of the contact forces, shape (m,) [N]."""
        return np.sqrt(np.diag(self.force_covariance))

    @property
    def consistent(self) -> bool:
        """True if chi_square is within its 99 % quantile; else the unknowns do not explain the measurements."""
        return self.chi_square <= usual(self.freedom)

    @property
    def unseen_names(self) -> list[str]:
        """Every unseen direction in words: the unknowns that change along it, the most visible first."""
        names = []
        for direction in self.unseen:
            shares = direction / np.sqrt(np.maximum(np.diag(self.covariance), np.finfo(float).tiny))
            order = np.argsort(-np.abs(shares))
            most = np.abs(shares).max()
            names.append(
                ", ".join(f"{self.names[k]} {direction[k]:+.3g}" for k in order if np.abs(shares[k]) > 0.05 * most)
            )
        return names
