"""The points of all tests, each test with the same weight, and parts of each that are left out in turn."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields

import numpy as np

from fingerfem.material_fit.measurements import Measurement
from fingerfem.material_fit.stresses import principal_stretches
from rom.brief import brief

BINS = 50  # of a test's logarithmic stretch; the points of a bin have together the weight of one
BLOCKS, FOLDS = 9, 3  # of a test's points in their order; every third block is left out together


@brief
@dataclass(frozen=True, kw_only=True)
class Points:
    """Points of one test or several; all arrays have shape (points,).

    Attributes:
        mode: of the point's test.
        stretch: along the pull [-].
        stress: force over the area at rest [Pa].
        peak: largest stress of the point's test [Pa].
        weight: of the point's squared error; 1 in sum [-].
        fold: the points of equal number are left out together.
    """

    mode: np.ndarray
    stretch: np.ndarray
    stress: np.ndarray
    peak: np.ndarray
    weight: np.ndarray
    fold: np.ndarray

    def where(self, kept: np.ndarray) -> Points:
        """The points at which a mask, shape (points,), is true."""
        return Points(**{field.name: getattr(self, field.name)[kept] for field in fields(self)})

    def by_mode(self, quantity: Callable[[str, np.ndarray], np.ndarray]) -> np.ndarray:
        """A function of mode and stretches, shape (points of the mode, ...), of all points, (points, ...)."""
        values_by_mode = {
            mode: quantity(mode, self.stretch[self.mode == mode]) for mode in dict.fromkeys(self.mode.tolist())
        }
        result = np.empty((len(self.mode), *next(iter(values_by_mode.values())).shape[1:]))
        for mode, values in values_by_mode.items():
            result[self.mode == mode] = values
        return result

    @property
    def scale(self) -> np.ndarray:
        """Scale of an error's contribution: the root of the weight, over the peak, shape (points,) [1/Pa]."""
        return np.sqrt(self.weight) / self.peak

    @property
    def principal(self) -> tuple[float, float]:
        """Lowest and highest principal stretch [-]."""
        stretches = self.by_mode(principal_stretches)
        return float(stretches.min()), float(stretches.max())


def points_of(measurements: Sequence[Measurement]) -> Points:
    """The points of tests, weighted so that neither dense data nor a test of many points dominates."""
    modes, weights, folds = [], [], []
    for one in measurements:
        strain = np.log(one.stretch)
        edges = np.linspace(strain[0], strain[-1], BINS + 1)[1:-1]
        _, bin_of, count = np.unique(np.digitize(strain, edges), return_inverse=True, return_counts=True)
        different, rank = np.unique(strain, return_inverse=True)
        modes.append(np.full(len(strain), one.mode))
        weights.append(1 / count[bin_of] / len(count) / len(measurements))
        folds.append(rank * BLOCKS // len(different) % FOLDS)
    return Points(
        mode=np.concatenate(modes),
        stretch=np.concatenate([one.stretch for one in measurements]),
        stress=np.concatenate([one.stress for one in measurements]),
        peak=np.concatenate([np.full(len(one.stress), one.peak) for one in measurements]),
        weight=np.concatenate(weights),
        fold=np.concatenate(folds),
    )
