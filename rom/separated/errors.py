"""The estimated errors of a separated model, from its differences to what it should answer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.ndimage import distance_transform_edt, maximum_filter, percentile_filter

from rom.separated.model import Errors, SeparatedModel

MARGIN = 1e-3  # share of the range of d: the least margin of contact paths
COVERED = 0.97  # of the calibrating points [-]
COLUMNS = "tip", "contact_force", "displacement", "pad_pressure"  # of rates
SHARP, FEW = 85, 0.1  # percentile, among a cell and its neighbours, of a local rate; points a cell that make it local


def with_errors(
    table: SeparatedModel, points: np.ndarray, off: Mapping[str, np.ndarray], valid: np.ndarray, cells: int
) -> SeparatedModel:
    """The model with its estimated errors: per length of contact path, by cells of the tensions and s.

    Cells in contact with points that are not valid, or next to one, are marked, and where an estimate exceeds all
    forces.

    Args:
        table: the model.
        points: shape (n, p), inside its limits or without the object.
        off: by quantity in its unit, the differences to the source and the source's own error, shapes (n,).
        valid: whether the source has an answer, shape (n,).
        cells: along every parameter.

    Raises:
        ValueError: no valid points.
    """
    if not valid.any():
        raise ValueError("the source must have an answer at some tensions and distances, got none")
    answers, (lower, upper), shape = table.evaluate(points), table.limits, (cells,) * points.shape[1]
    late = float(np.quantile(off["touch_distance"][valid], COVERED))
    margin = max(MARGIN * float(upper[-1] - lower[-1]), late)
    path = answers.touch_distance - points[:, -1]
    pressed = path + margin > margin
    shares = (points - lower) / (upper - lower)
    shares[:, -1] = np.where(pressed, path / np.maximum(answers.touch_distance - lower[-1], margin), 0.0)
    own = np.ravel_multi_index(tuple(np.clip(shares * cells, 0, cells - 1).astype(int).T), shape)
    free, pressed, length = valid & ~pressed, valid & pressed, path + margin
    alone, rates = dict.fromkeys(COLUMNS, 0.0), np.zeros((cells ** len(shape), len(COLUMNS) - 1 + table.has_pad))
    for column, name in enumerate(COLUMNS):
        if name in ("tip", "displacement") and name in off and free.any():
            alone[name] = float(np.quantile(off[name][free], COVERED))
        if name in off:
            grown = np.maximum(off[name] - alone[name], 0.0)[pressed] / length[pressed]
            rates[:, column] = _local(own[pressed], grown, shape)
    lost = pressed & (rates[own, 1] * length > np.max(answers.contact_force[pressed], initial=0.0))
    marked = np.zeros(shape, bool)
    marked.reshape(-1)[own[(~valid & (path > 0)) | lost]] = True
    marked = maximum_filter(marked, size=3, mode="nearest").reshape(-1)
    rates[marked] = np.inf
    errors = Errors(
        tip=alone["tip"], displacement=alone["displacement"], touch_distance=late, contact=rates, margin=margin
    )
    return replace(table, errors=errors, answered=~marked)


def _local(own: np.ndarray, rates: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """By cell: the largest rate in it, or what most of its neighbours are below, if that is more.

    Everywhere what COVERED of all are below, if there are too few rates: then they do not resolve the cells.
    """
    if len(rates) < FEW * np.prod(shape):
        return np.full(np.prod(shape), np.quantile(rates, COVERED) if rates.size else 0.0)
    largest = np.full(shape, -1.0)
    np.maximum.at(largest.reshape(-1), own, rates)
    largest = largest[tuple(distance_transform_edt(largest < 0, return_distances=False, return_indices=True))]
    return np.maximum(largest, percentile_filter(largest, SHARP, size=3, mode="nearest")).reshape(-1)


def enlarged(table: SeparatedModel, factors: Mapping[str, float]) -> SeparatedModel:
    """The model with its estimated errors times factors, by quantity [-]."""
    errors, factor = table.errors, {name: factors.get(name, 1.0) for name in (*COLUMNS, "touch_distance")}
    late, columns = factor["touch_distance"] * errors.touch_distance, COLUMNS[: errors.contact.shape[1]]
    enlarged = Errors(
        tip=factor["tip"] * errors.tip,
        displacement=factor["displacement"] * errors.displacement,
        touch_distance=late,
        contact=errors.contact * [factor[name] for name in columns],
        margin=max(errors.margin, late),
    )
    return replace(table, errors=enlarged)
