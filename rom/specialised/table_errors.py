"""The estimated errors of a table, from its differences to what it should answer; and how large these are."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from scipy.ndimage import distance_transform_edt, maximum_filter, percentile_filter

from rom.brief import brief
from rom.components import Errors
from rom.error_statistics import norm, statistics
from rom.rod.rod import QUANTITIES
from rom.surrogate import Surrogate

MARGIN = 1e-3  # share of the range of d: contact paths below which errors do not become smaller
COVERED = 0.97  # of the calibrating points [-]
FELT = 0.1  # force below which a relative error says nothing [N]
SHARP = 85  # percentile, among a cell and its neighbours, that a local rate is
FEW = 0.1  # points in contact a cell, from which on rates are local


@brief
class Truth(NamedTuple):
    """What a table should answer at n points, and the estimated errors of that.

    Attributes:
        points: shape (n, p).
        out: shape (n, 5).
        errors: of tip [m], contact force [N] and touch distance [m], estimated, shape (n, 3).
        inside: whether the answer counts, shape (n,).
    """

    points: np.ndarray
    out: np.ndarray
    errors: np.ndarray
    inside: np.ndarray


def with_errors(table: Surrogate, truth: Truth) -> Surrogate:
    """The table with its estimated errors: its difference from the truth at some points, and the truth's own.

    Cells of the contact path that hold points which do not count, or are next to one that does, are marked.
    """
    points, ours, good = truth.points, table.outputs(truth.points), truth.inside
    if not good.any():
        raise ValueError("the source must have an answer at some tensions and distances, got none")
    tip, force, touch = (off + own for off, own in zip(_differences(ours, truth.out), truth.errors.T, strict=True))
    lower, upper = table.limits
    p, margin = len(lower), MARGIN * float(upper[-1] - lower[-1])
    path = ours[:, 4] - points[:, -1]
    free, pushed = good & (path <= 0), good & (path > 0)
    own, side = _cells(table, points, ours[:, 4])
    free_tip = float(np.quantile(tip[free], COVERED)) if free.any() else 0.0
    rates = np.zeros((side**p, 3))
    for column, errors in enumerate((np.maximum(tip - free_tip, 0.0), force)):
        rates[:, column] = _rates(own[pushed], errors[pushed] / (path[pushed] + margin), side, p)
    # An estimate that is larger than all forces says nothing.
    lost = pushed & (rates[own, 1] * (path + margin) > truth.out[pushed, 3].max(initial=0.0))
    bad = own[(~good & (path > 0)) | lost]
    unknown = _around(bad, side, p)
    rates[unknown] = np.inf
    errors = Errors(
        tip=free_tip,
        displacement=0.0,
        touch_distance=float(np.quantile(touch[good], COVERED)),
        contact=rates,
        margin=margin,
    )
    return replace(table, errors=errors, possible_regimes=(~unknown).astype(np.uint64))


def _differences(ours: np.ndarray, truth: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of tips [m], contact forces [N] and touch distances [m], of answers of shape (n, 5), shapes (n,)."""
    return norm(ours[:, :3] - truth[:, :3]), np.abs(ours[:, 3] - truth[:, 3]), np.abs(ours[:, 4] - truth[:, 4])


def _cells(table: Surrogate, points: np.ndarray, touch: np.ndarray) -> tuple[np.ndarray, int]:
    """Cell of the lookup of every point, shape (n,), and how many cells an axis has."""
    p = points.shape[1]
    side = round(len(table.regime_lookup) ** (1 / p))
    lower, upper = table.limits
    shares = (points - lower) / (upper - lower)
    shares[:, -1] = table.coordinates.of(points, touch)[:, -1]
    index = np.clip(shares * side, 0, side - 1).astype(int)
    return np.ravel_multi_index(tuple(index.T), (side,) * p), side


def _rates(own: np.ndarray, rates: np.ndarray, side: int, p: int) -> np.ndarray:
    """By cell: the largest rate in it, or what most of its neighbours are below, if that is more.

    Everywhere what COVERED of all are below, if there are too few rates: then they do not resolve the cells.
    """
    if len(rates) < FEW * side**p:
        return np.full(side**p, float(np.quantile(rates, COVERED)) if rates.size else 0.0)
    found = np.full((side,) * p, -1.0)
    np.maximum.at(found.reshape(-1), own, rates)
    nearest = tuple(distance_transform_edt(found < 0, return_distances=False, return_indices=True))
    found = found[nearest]
    return np.maximum(found, percentile_filter(found, SHARP, size=3, mode="nearest")).reshape(-1)


def _around(cells: np.ndarray, side: int, p: int) -> np.ndarray:
    """Some cells and their neighbours, shape (side^p,)."""
    found = np.zeros((side,) * p, bool)
    found.reshape(-1)[cells] = True
    return maximum_filter(found, size=3, mode="nearest").reshape(-1)


def compared(table: Surrogate, truth: Truth) -> dict[str, dict[str, Any]]:
    """Errors of a table where both it and the truth count, by quantity, see `statistics`.

    Those of tip and force are relative to themselves, those of the touch distance to the range of d; `decided` is the
    share of the points at which both touch, or neither does.
    """
    answer = table.evaluate(truth.points)
    both = truth.inside & np.asarray(answer.inside, bool)
    ours = np.column_stack([answer.tip, answer.contact_force, answer.touch_distance])[both]
    true, estimates = truth.out[both], [np.asarray(answer.error[name])[both] for name in QUANTITIES]
    tip, force, touch = _differences(ours, true)
    felt, (lower, upper) = true[:, 3] > FELT, table.limits
    decided = {"decided": float(np.mean((ours[:, 3] > 0) == (true[:, 3] > 0)))}
    return {
        "tip": statistics(tip, norm(true[:, :3]), estimates[0]),
        "contact_force": statistics(force[felt], true[felt, 3], estimates[1][felt]),
        "touch_distance": statistics(touch, np.full(len(touch), upper[-1] - lower[-1]), estimates[2]) | decided,
    }
