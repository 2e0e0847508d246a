"""Measurements that do not fit the others: left out one by one, and named."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.stats import chi2

from control.calibration.fit import Fit, fit
from control.calibration.measured import GROUPS, Measured
from rom.files.csv_table import Refused

RISK = 1e-3  # probability that a log without outliers shows one [-]
ROUNDS, MOST = 5, 0.2  # of leaving out; largest share of a group that may be left out [-]
FEWEST = 2  # poses


def without_outliers(measured: Measured, found: Fit, noise: Mapping[str, float]) -> tuple[Measured, Fit, list[str]]:
    """The log without its outliers, its fit, and a line about each group that has some.

    A measurement of a pose, such as a position with three components, is one if the square of its studentised
    residual, over the median of those of all poses, exceeds its chi-squared quantile, and it exceeds usual noise.
    """
    excluded = {name: np.zeros(len(found.tensions), bool) for name in measured.groups}
    for _ in range(ROUNDS):
        far = {name: _far(measured, found, name) & ~excluded[name] for name in measured.groups}
        if not any(one.any() for one in far.values()):
            break
        excluded = {name: excluded[name] | far[name] for name in measured.groups}
        crowded = [name for name, one in excluded.items() if one.mean() > MOST]
        if crowded:
            line = f"more than {100 * MOST:g} % of {crowded[0].replace('_', ' ')} are outliers: none was left out"
            return replace(measured, excluded={}), fit(replace(measured, excluded={}), noise, found), [line]
        measured = replace(measured, excluded=excluded)
        found = fit(measured, noise, found)
    lines = [
        f"outliers: {name.replace('_', ' ')} in {_lines(measured, rows)}; left out"
        for name, rows in excluded.items()
        if rows.any()
    ]
    return measured, found, lines


def _far(measured: Measured, found: Fit, group: str) -> np.ndarray:
    """Poses whose measurement of a group is an outlier, shape (n,)."""
    own = np.flatnonzero(np.array(measured.columns) == group)
    projected = found.projected[:, own]
    spread = found.projector[:, own[:, None], own] - projected @ found.covariance @ np.swapaxes(projected, 1, 2)
    values = found.residuals[:, own]
    inverse = np.linalg.pinv(spread, rcond=1e-6, hermitian=True)
    ranks = np.linalg.matrix_rank(spread, tol=1e-6, hermitian=True)
    ranks = np.minimum(ranks, measured.used[:, own].sum(axis=1))
    squares = np.einsum("ni,nij,nj->n", values, inverse, values)
    small = np.linalg.norm(values, axis=1) * found.noise[group] < GROUPS[group][1]
    some = ranks > 0
    if some.sum() <= FEWEST:
        return np.zeros(len(squares), bool)
    degrees = np.maximum(ranks, 1)
    typical = float(np.median(squares[some] / chi2.median(degrees[some])))
    return some & ~small & (squares > chi2.isf(RISK / len(squares), degrees) * max(typical, 1e-12))


def within_domain(measured: Measured, found: Fit, noise: Mapping[str, float]) -> tuple[Measured, Fit, list[str]]:
    """The log without poses beyond the trained domain at the fitted parameters, its fit, and a line about them."""
    gone: list[int] = []
    for _ in range(ROUNDS):
        upper = measured.ends(found.unknowns)[1]
        beyond = ~found.inside | (found.tensions >= upper).any(axis=1)
        if not beyond.any():
            break
        gone += measured.log.lines[beyond].tolist()
        if (~beyond).sum() < FEWEST:
            at = int(np.argmax(beyond))
            limits = ", ".join(f"{end:.3g}" for end in upper)
            raise Refused(
                f"{measured.log.where(at)}: tensions must be below {limits} N, where the finger was trained at the "
                f"fitted parameters, got more in {len(gone)} of {len(gone) + int((~beyond).sum())} poses"
            )
        measured = replace(measured, log=measured.log.only(~beyond))
        found = fit(measured, noise, replace(found, tensions=found.tensions[~beyond]))
    if not gone:
        return measured, found, []
    lines = f"line{'s' if len(gone) > 1 else ''} {', '.join(map(str, sorted(gone)))}"
    return measured, found, [f"beyond the trained domain at the fitted parameters: {lines}; left out"]


def _lines(measured: Measured, rows: np.ndarray) -> str:
    """Lines of the file."""
    numbers = measured.log.lines[rows].tolist()
    return f"line{'s' if len(numbers) > 1 else ''} {', '.join(map(str, numbers))}"
