"""Weighted least squares over parameters and the tensions of every pose, and the noise of every quantity.

Residuals r, whitened by their noise, depend on the unknowns x and, pose by pose, on the tensions u. With the
derivatives A = dr/du and B = dr/dx of a pose, the projector P = 1 - A A^+ removes its tensions (variable projection):

    H = sum B^T P B,    H dx = -sum B^T P r,    du = -A^+ (r + B dx).

The variance of every quantity is estimated by its residuals over its redundancy, the trace of the residuals' projector
over its columns (W. Foerstner, Allgemeine Vermessungs-Nachrichten 86, 1979).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from control.calibration.measured import GROUPS, Measured, Residuals
from control.calibration.parameters import DETERMINED
from rom.brief import brief

ITERATIONS, SETTLED = 60, 1e-13  # most steps; converged: decrease of the cost that a step predicts, over the cost [-]
NOISE_STEPS, NOISE_SETTLED = 30, 1e-3  # of the noise's estimate; converged: its relative change [-]
ROUGH = 1e-4  # as SETTLED, while the noise changes [-]
LEAST_REDUNDANCY = 3.0  # below that the noise of a quantity is not estimated, but assumed [-]
LEAST_NOISE = 1e-3  # over the first guess: below that the model's own error is larger [-]
NOTHING = 1e-16  # cost of a fit without residuals [-]
LEAST, LARGEST = 1e-9, 1e6  # first damping after a step without decrease; damping at which the fit stops [-]
RANK = 1e-9  # singular values of A below this share of the largest are zero [-]


class NotFitted(ValueError):
    """A fit that did not converge: one line."""


@brief
@dataclass(frozen=True, kw_only=True)
class Fit:
    """A solution.

    Attributes:
        unknowns: x, shape (p,).
        tensions: of every pose, shape (n, t) [N].
        noise: standard deviation of every quantity; relative ones over the value.
        estimated: quantities whose noise was estimated.
        residuals: model minus measurement, whitened, shape (n, m).
        redundancy: diagonal of the residuals' projector, shape (n, m) [-].
        covariance: of the unknowns; 0 along what the log does not determine, shape (p, p).
        undetermined: directions of the scaled unknowns, x over `Unknowns.spreads`, that the log does not determine,
            with their variances, shapes (k, p) and (k,).
        whitening: one over the standard deviations, shape (n, m).
        projector: P, shape (n, m, m).
        projected: P B, shape (n, m, p).
        inside: whether the model is within its trained domain, shape (n,).
    """

    unknowns: np.ndarray
    tensions: np.ndarray
    noise: dict[str, float]
    estimated: tuple[str, ...]
    residuals: np.ndarray
    redundancy: np.ndarray
    covariance: np.ndarray
    undetermined: tuple[np.ndarray, np.ndarray]
    whitening: np.ndarray
    projector: np.ndarray
    projected: np.ndarray
    inside: np.ndarray


@brief
class Normal(NamedTuple):
    """The whitened problem at one point, with the tensions projected out."""

    cost: float
    whitening: np.ndarray
    residuals: np.ndarray
    by_unknown: np.ndarray
    inverse: np.ndarray
    projector: np.ndarray

    @property
    def reducible(self) -> float:
        """By how much the tensions alone can lower the cost."""
        rest = np.einsum("nij,nj->ni", self.projector, self.residuals)
        return max(self.cost - float((rest**2).sum()), 0.0)

    @property
    def projected(self) -> np.ndarray:
        """P B."""
        return self.projector @ self.by_unknown


def fit(measured: Measured, noise: Mapping[str, float], start: Fit | None = None) -> Fit:
    """The parameters and tensions with the least weighted residuals.

    Args:
        measured: the log before the finger.
        noise: known standard deviations by quantity; others are estimated. Larger residuals replace known ones, as
            they contain the model's own error.
        start: where to begin.

    Raises:
        NotFitted: no convergence.
    """
    unknowns = np.zeros(len(measured.unknowns.names)) if start is None else start.unknowns
    sigma = {name: noise.get(name, GROUPS[name][1]) for name in measured.groups} if start is None else start.noise
    tensions = first_tensions(measured, unknowns, sigma) if start is None else start.tensions
    for _ in range(NOISE_STEPS):
        unknowns, tensions, normal, inside = _minimise(measured, sigma, unknowns, tensions, ROUGH)
        solution = _solution(measured, sigma, unknowns, tensions, normal, inside)
        changed, estimated = _noise(measured, solution, noise)
        far = max(abs(np.log(changed[name] / sigma[name])) for name in sigma)
        sigma = changed
        if far < NOISE_SETTLED:
            break
    unknowns, tensions, normal, inside = _minimise(measured, sigma, unknowns, tensions, SETTLED)
    return _solution(measured, sigma, unknowns, tensions, normal, inside, estimated)


def first_tensions(measured: Measured, unknowns: np.ndarray, sigma: Mapping[str, float]) -> np.ndarray:
    """Tensions to begin with, shape (n, t) [N]: the measured ones, or those that fit all other columns."""
    lower, upper = measured.ends(unknowns)
    log, radius = measured.log, measured.unknowns.values(unknowns)["pulley_radius"]
    known = np.where(np.isfinite(log.tension), log.tension, log.torque / radius)
    begun = np.clip(np.where(np.isfinite(known), known, lower + 0.2 * (upper - lower)), lower, upper)
    return begun if np.isfinite(known).all() else settle(measured, sigma, unknowns, begun)


def settle(measured: Measured, sigma: Mapping[str, float], unknowns: np.ndarray, tensions: np.ndarray) -> np.ndarray:
    """Tensions, pose by pose, with the least weighted residuals at unknowns, shape (n, t) [N]."""
    damping, cost = np.full(len(tensions), 1e-3), np.full(len(tensions), np.inf)
    best, steps = tensions, np.zeros_like(tensions)
    for _ in range(ITERATIONS):
        tried = np.clip(best + steps, *measured.ends(unknowns))
        normal, _ = _normal(measured, sigma, unknowns, tried, damping)
        own = (normal.residuals**2).sum(axis=1)
        better = own < cost
        best = np.where(better[:, None], tried, best)
        damping = np.where(better, damping / 10, damping * 10)
        done = not better.any() or (cost - own)[better].max() <= SETTLED * max(float(own.max()), 1e-20)
        cost = np.where(better, own, cost)
        steps = np.where(better[:, None], -np.einsum("ntm,nm->nt", normal.inverse, normal.residuals), steps / 10)
        if done and np.isfinite(cost).all():
            break
    return best


def _normal(
    measured: Measured,
    sigma: Mapping[str, float],
    unknowns: np.ndarray,
    tensions: np.ndarray,
    damping: np.ndarray | None = None,
) -> tuple[Normal, np.ndarray]:
    """The whitened problem, and where the model is inside; with damping, A^+ is damped per pose."""
    own: Residuals = measured.residuals(unknowns, tensions)
    scale = 1 / (np.array([sigma[name] for name in measured.columns]) * measured.weights)
    residuals, by_tension = own.values * scale, own.by_tension * scale[..., None]
    lower, upper = measured.ends(unknowns)
    gradient = np.einsum("nmt,nm->nt", by_tension, residuals)
    stuck = ((tensions <= lower) & (gradient > 0)) | ((tensions >= upper) & (gradient < 0)) | measured.slack
    by_tension = np.where(stuck[:, None], 0.0, by_tension)
    left, values, right = np.linalg.svd(by_tension, full_matrices=False)
    kept = values > RANK * np.maximum(values[:, :1], 1e-300)
    limit = 0.0 if damping is None else damping[:, None] * (values**2).max(axis=1, keepdims=True)
    factors = np.where(kept, values / np.where(kept, values**2 + limit, 1.0), 0.0)
    inverse = np.swapaxes(right, 1, 2) @ (factors[:, :, None] * np.swapaxes(left, 1, 2))
    kept_left = left * kept[:, None]
    projector = np.eye(residuals.shape[1]) - kept_left @ np.swapaxes(kept_left, 1, 2)
    cost = float((residuals**2).sum())
    return Normal(cost, scale, residuals, own.by_unknown * scale[..., None], inverse, projector), own.inside


def _minimise(
    measured: Measured, sigma: Mapping[str, float], unknowns: np.ndarray, tensions: np.ndarray, settled: float
) -> tuple[np.ndarray, np.ndarray, Normal, np.ndarray]:
    """Levenberg-Marquardt; steps stay at zero along what the log does not determine."""
    damping, spreads = 1e-4, measured.unknowns.spreads
    normal, inside = _normal(measured, sigma, unknowns, tensions)
    for _ in range(ITERATIONS):
        values, axes = _spectrum(normal, spreads)
        gradient = axes.T @ (spreads * np.einsum("nmp,nm->p", normal.projected, normal.residuals))
        determined = values > DETERMINED**-2
        predicted = normal.reducible + float((gradient[determined] ** 2 / values[determined]).sum())
        if predicted <= settled * normal.cost or normal.cost < NOTHING or damping > LARGEST:
            return unknowns, tensions, normal, inside
        stiffness = np.where(determined, values + damping * values.max(), np.inf)
        scaled = -axes @ (gradient / stiffness)
        step = spreads * scaled
        inner = normal.residuals + np.einsum("nmp,p->nm", normal.by_unknown, step)
        tried = unknowns + step
        pulled = np.clip(tensions - np.einsum("ntm,nm->nt", normal.inverse, inner), *measured.ends(tried))
        following, seen = _normal(measured, sigma, tried, pulled)
        gain = normal.cost - following.cost
        if gain >= 0:
            unknowns, tensions, normal, inside, damping = tried, pulled, following, seen, damping / 10
        else:
            damping = max(10 * damping, LEAST)
    raise NotFitted(
        f"{measured.log.path}: the fit must converge in {ITERATIONS} steps, got a decrease of {predicted:.2g} ahead"
    )


def _spectrum(normal: Normal, spreads: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues and eigenvectors, in columns, of the information about the scaled unknowns."""
    projected = normal.projected * spreads
    values, axes = np.linalg.eigh(np.einsum("nmp,nmq->pq", projected, projected))
    return values, axes


def _solution(
    measured: Measured,
    sigma: Mapping[str, float],
    unknowns: np.ndarray,
    tensions: np.ndarray,
    normal: Normal,
    inside: np.ndarray,
    estimated: tuple[str, ...] = (),
) -> Fit:
    """The solution at the minimum, with its covariance."""
    spreads = measured.unknowns.spreads
    values, axes = _spectrum(normal, spreads)
    determined = values > DETERMINED**-2
    own = spreads[:, None] * axes[:, determined]
    covariance = own @ np.diag(1 / values[determined]) @ own.T
    projected = normal.projected
    redundancy = np.einsum("nii->ni", normal.projector) - np.einsum("nmp,pq,nmq->nm", projected, covariance, projected)
    return Fit(
        unknowns=unknowns,
        tensions=tensions,
        noise=dict(sigma),
        estimated=estimated,
        residuals=normal.residuals,
        redundancy=np.where(measured.used, redundancy, 0.0),
        covariance=covariance,
        undetermined=(axes[:, ~determined].T, 1 / np.maximum(values[~determined], 1e-12)),
        whitening=normal.whitening,
        projector=normal.projector,
        projected=projected,
        inside=inside,
    )


def _noise(measured: Measured, found: Fit, known: Mapping[str, float]) -> tuple[dict[str, float], tuple[str, ...]]:
    """Standard deviations by residuals over redundancy, and of which quantities they are estimated."""
    columns, result, estimated = np.array(measured.columns), dict(found.noise), []
    for name in measured.groups:
        own = columns == name
        redundancy = float(found.redundancy[:, own].sum())
        if redundancy < LEAST_REDUNDANCY:
            continue
        ratio = float(np.sqrt((found.residuals[:, own] ** 2).sum() / redundancy))
        least = known.get(name, LEAST_NOISE * GROUPS[name][1])
        result[name] = max(found.noise[name] * ratio, least)
        if result[name] > least:
            estimated.append(name)
    return result, tuple(estimated)


def information(
    measured: Measured, sigma: Mapping[str, float], unknowns: np.ndarray, tensions: np.ndarray
) -> np.ndarray:
    """H, the information of a log about the unknowns, shape (p, p), at unknowns and tensions."""
    normal, _ = _normal(measured, sigma, unknowns, tensions)
    return np.einsum("nmp,nmq->pq", normal.projected, normal.projected)
