"""The estimated errors of a separated model, from its differences to what it should answer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import distance_transform_edt, maximum_filter, percentile_filter

from rom.brief import brief
from rom.files.checked_file import require
from rom.parametric_model import ParametricModel

MARGIN = 1e-3  # share of the range of d: the least margin of contact paths
COVERED = 0.97  # of the calibrating points [-]
COLUMNS = "tip", "contact_force", "displacement", "pad_pressure"  # of Errors.contact
SHARP, FEW = 85, 0.1  # percentile, among a cell and its neighbours, of a local rate; points a cell that make it local


@brief
@dataclass(frozen=True, kw_only=True)
class Errors:
    """Estimated errors, meant to cover 95 % of the true ones.

    Attributes:
        tip: without contact [m].
        displacement: without contact, root mean square over the nodes [m]; 0 without the field.
        touch_distance: [m].
        contact: of tip, contact force, displacement and, if the model has it, pad pressure, per length of contact path
            [-, N/m, -, Pa/m], by cells of tensions and s, shape (cells, ..., 3 or 4); infinite without an answer.
        margin: added to the contact path [m]. It is at least the error of the touch distance.
    """

    tip: float
    displacement: float
    touch_distance: float
    contact: np.ndarray
    margin: float

    @property
    def alone(self) -> np.ndarray:
        """Errors without contact in the columns of `contact`, shape (3 or 4,)."""
        return np.array([self.tip, 0.0, self.displacement, 0.0])[: self.contact.shape[-1]]

    @property
    def answered(self) -> np.ndarray:
        """True for cells whose samples support an answer, shape (cells, ...)."""
        return np.isfinite(self.contact).all(axis=-1)

    def scaled(self, factors: Mapping[str, float]) -> Errors:
        """The errors times factors by quantity, 1 by default [-]."""
        factor = {name: factors.get(name, 1.0) for name in (*COLUMNS, "touch_distance")}
        own = {name: factor[name] * getattr(self, name) for name in ("tip", "displacement", "touch_distance")}
        contact = self.contact * [factor[name] for name in COLUMNS[: self.contact.shape[-1]]]
        return Errors(**own, contact=contact, margin=max(self.margin, own["touch_distance"]))


def estimated(
    table: ParametricModel, points: np.ndarray, off: Mapping[str, np.ndarray], valid: np.ndarray, cells: int
) -> Errors:
    """The errors of a separated model, in contact per length of its path and by cells of the tensions and s.

    Rates are infinite in cells in contact with points that are not valid, or next to one, and where an estimate exceeds
    all forces.

    Args:
        table: the model.
        points: shape (n, p), inside its limits or without the object.
        off: by quantity in its unit, the differences to the source and the source's own error, shapes (n,).
        valid: whether the source has an answer, shape (n,).
        cells: along every parameter.

    Raises:
        ModelError: no valid points.
    """
    require(bool(valid.any()), "the source must have an answer at some tensions and distances", "none")
    answers, (lower, upper), shape = table.evaluate(points), table.limits, (cells,) * points.shape[1]
    late = _covering(off["touch_distance"][valid])
    margin = max(MARGIN * float(upper[-1] - lower[-1]), late)
    path = answers.touch_distance - points[:, -1]
    length, touched = path + margin, path > 0
    free, pressed = valid & ~touched, valid & touched
    shares = (points - lower) / (upper - lower)
    shares[:, -1] = np.where(touched, path / np.maximum(answers.touch_distance - lower[-1], margin), 0.0)
    own = np.clip(shares * cells, 0, cells - 1).astype(int)
    off = dict.fromkeys(COLUMNS, np.zeros(len(points))) | dict(off)  # some have no displacement
    alone = {name: _covering(off[name][free]) for name in ("tip", "displacement")}
    names = COLUMNS[:-1] if answers.pad_pressure is None else COLUMNS
    grown = [np.maximum(off[name] - alone.get(name, 0.0), 0.0)[pressed] for name in names]
    rates = np.stack([_local(own[pressed], one / length[pressed], shape) for one in grown], axis=-1)
    lost = pressed & (rates[(*own.T, 1)] * length > np.max(answers.contact_force[pressed], initial=0.0))
    marked = np.zeros(shape, bool)
    marked[tuple(own[(~valid & touched) | lost].T)] = True
    rates[maximum_filter(marked, size=3, mode="nearest")] = np.inf
    return Errors(**alone, touch_distance=late, contact=rates, margin=margin)


def _covering(errors: np.ndarray) -> float:
    """The bound that COVERED of the errors are below, 0 without any."""
    return float(np.quantile(errors, COVERED)) if errors.size else 0.0


def _local(own: np.ndarray, rates: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """Rates by cell, shape (cells, ...): its largest, or a bound of most of its neighbours', if that is more.

    Too few rates do not resolve the cells: then every cell has the bound of all.
    """
    if len(rates) < FEW * np.prod(shape):
        return np.full(shape, _covering(rates))
    largest = np.full(shape, -1.0)
    np.maximum.at(largest, tuple(own.T), rates)
    largest = largest[tuple(distance_transform_edt(largest < 0, return_distances=False, return_indices=True))]
    return np.maximum(largest, percentile_filter(largest, SHARP, size=3, mode="nearest"))
