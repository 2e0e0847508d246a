"""The estimated errors of a table, from its differences to what it should answer; and how large these are."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from scipy.ndimage import distance_transform_edt, maximum_filter, percentile_filter

from rom.brief import brief
from rom.elements.calibration import conformal
from rom.error_statistics import mean_size, norm, statistics
from rom.native.answer import FORCE, PAD, TOUCH
from rom.separated.model import SeparatedModel
from rom.separated.parts import Errors

MARGIN = 1e-3  # share of the range of d: the least margin of contact paths
COVERED = 0.97  # of the calibrating points [-]
FELT = 0.1  # force below which a relative error says nothing [N]
COLUMNS = "tip", "contact_force", "displacement", "pad_pressure"  # of rates
FREE = {"tip", "displacement"}  # quantities with an error without contact that contact's adds to
SHARP = 85  # percentile, among a cell and its neighbours, that a local rate is
FEW = 0.1  # points in contact a cell, from which on rates are local


@brief
class Truth(NamedTuple):
    """What a table should answer at n points, and the estimated errors of that.

    Attributes:
        points: shape (n, p).
        out: tip [m], contact force [N], touch distance [m], pad pressure [Pa] if there is one, shape (n, 5 or 6).
        errors: of tip [m], contact force [N] and touch distance [m], estimated, shape (n, 3).
        inside: whether the answer counts, shape (n,).
        displacement: of the table's nodes, shape (n, nodes, 3) [m]; None if it has none.
    """

    points: np.ndarray
    out: np.ndarray
    errors: np.ndarray
    inside: np.ndarray
    displacement: np.ndarray | None = None


def with_errors(table: SeparatedModel, truth: Truth) -> SeparatedModel:
    """The table with its estimated errors: its difference from the truth at some points, and the truth's own.

    Cells of the contact path that hold points which do not count, or are next to one that does, are marked.
    """
    points, ours, good = truth.points, table.outputs(truth.points), truth.inside
    if not good.any():
        raise ValueError("the source must have an answer at some tensions and distances, got none")
    off = _differences(table, ours, truth)
    for name, own in zip(("tip", "contact_force", "touch_distance"), truth.errors.T, strict=True):
        off[name] = off[name] + own
    lower, upper = table.limits
    p, late = len(lower), float(np.quantile(off["touch_distance"][good], COVERED))
    margin = max(MARGIN * float(upper[-1] - lower[-1]), late)
    length = ours[:, TOUCH] - points[:, -1] + margin
    free, pushed = good & (length <= margin), good & (length > margin)
    own, side = _cells(table, points, ours[:, TOUCH]), table.cells
    without = {name: float(np.quantile(off[name][free], COVERED)) if free.any() else 0.0 for name in off.keys() & FREE}
    rates = np.zeros((side**p, 3 + table.has_pad))
    for column, name in enumerate(COLUMNS):
        if name in off:
            grown = np.maximum(off[name] - without.get(name, 0.0), 0.0)
            rates[:, column] = _rates(own[pushed], grown[pushed] / length[pushed], side, p)
    # An estimate that is larger than all forces says nothing.
    lost = pushed & (rates[own, 1] * length > truth.out[pushed, FORCE].max(initial=0.0))
    marked = _around(own[(~good & (length > margin)) | lost], side, p)
    rates[marked] = np.inf
    errors = Errors(
        tip=without["tip"],
        displacement=without.get("displacement", 0.0),
        touch_distance=late,
        contact=rates,
        margin=margin,
    )
    return replace(table, errors=errors, answered=~marked)


def enlarged(table: SeparatedModel, truth: Truth) -> SeparatedModel:
    """The table with its estimated errors enlarged until they cover its difference from a truth of another mesh.

    The least factor is the conformal quantile, see `rom.elements.calibration`: it holds of states drawn like these.
    """
    off = _differences(table, table.outputs(truth.points), truth)
    late = _factor(table, truth, "touch_distance", off) * table.errors.touch_distance
    wider = replace(table.errors, touch_distance=late, margin=max(table.errors.margin, late))
    table = replace(table, errors=wider)
    factor = {name: _factor(table, truth, name, off) for name in off}
    return replace(
        table,
        errors=replace(
            wider,
            tip=factor["tip"] * wider.tip,
            displacement=factor.get("displacement", 1.0) * wider.displacement,
            contact=wider.contact * [factor.get(name, 1.0) for name in COLUMNS[: wider.contact.shape[1]]],
        ),
    )


def _factor(table: SeparatedModel, truth: Truth, name: str, off: dict[str, np.ndarray]) -> float:
    """What covers a quantity's differences [-], at least 1; 1 if the table estimates none."""
    answers = table.evaluate(truth.points)
    estimated = np.asarray(answers.error.get(name, 0.0))
    own = truth.inside & np.asarray(answers.inside, bool) & (estimated > 0)
    return max(conformal((off[name] / np.where(own, estimated, 1.0))[own]), 1.0) if own.any() else 1.0


def _differences(table: SeparatedModel, ours: np.ndarray, truth: Truth) -> dict[str, np.ndarray]:
    """Of tips [m], contact forces [N], touch distances [m], pad pressures [Pa] and displacements [m], shapes (n,).

    That of the displacement is the root mean square over the nodes.
    """
    found = {
        "tip": norm(ours[:, :3] - truth.out[:, :3]),
        "contact_force": np.abs(ours[:, FORCE] - truth.out[:, FORCE]),
        "touch_distance": np.abs(ours[:, TOUCH] - truth.out[:, TOUCH]),
    }
    if table.has_pad and truth.out.shape[1] > PAD:
        found["pad_pressure"] = np.abs(ours[:, PAD] - truth.out[:, PAD])
    if table.displacements is not None and truth.displacement is not None:
        pairs = zip(truth.points, truth.displacement, strict=True)
        found["displacement"] = np.array([mean_size(table.displacement(point) - true) for point, true in pairs])
    return found


def _cells(table: SeparatedModel, points: np.ndarray, touch: np.ndarray) -> np.ndarray:
    """Cell of every point, shape (n,)."""
    p, side = points.shape[1], table.cells
    lower, upper = table.limits
    shares = (points - lower) / (upper - lower)
    shares[:, -1] = table.coordinates.of(points, touch)[:, -1]
    index = np.clip(shares * side, 0, side - 1).astype(int)
    return np.ravel_multi_index(tuple(index.T), (side,) * p)


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


def compared(table: SeparatedModel, truth: Truth) -> dict[str, dict[str, Any]]:
    """Errors of a table where both it and the truth count, by quantity, see `statistics`.

    Those of tip and force are relative to themselves, those of the touch distance to the range of d; `decided` is the
    share of the points at which both touch, or neither does.
    """
    answer = table.evaluate(truth.points)
    both = truth.inside & np.asarray(answer.inside, bool)
    true, (lower, upper) = truth.out, table.limits
    sizes = {
        "tip": norm(true[:, :3]),
        "contact_force": true[:, FORCE],
        "touch_distance": np.full(len(true), upper[-1] - lower[-1]),
    }
    counted = {"contact_force": both & (true[:, FORCE] > FELT)}
    off = _differences(table, table.outputs(truth.points), truth)
    found: dict[str, dict[str, Any]] = {}
    for name, errors in off.items():
        own = counted.get(name, both) & (sizes[name] > 0)
        found[name] = statistics(errors[own], sizes[name][own], np.asarray(answer.error[name])[own])
    found["touch_distance"]["decided"] = float(np.mean((answer.contact_force > 0)[both] == (true[both, FORCE] > 0)))
    return found
