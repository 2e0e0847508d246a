"""The laws that an element's samples support: one regression, of which every set of fewer products is a part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from rom.brief import brief
from rom.elements.index_set import chosen, index_set
from rom.elements.law import ElementLaw
from rom.elements.regression import NormalEquations
from rom.elements.samples import Samples
from rom.snapshots.grid import levels

ROWS = 1.5  # rows a fit has at least for every coefficient [-]
LENGTH_POWERS = 3  # highest degree in the length
MARGIN = 1.2  # the box is so much larger than the largest inputs: other fingers reach a little beyond these [-]


@brief
@dataclass(frozen=True, kw_only=True)
class Candidates:
    """Laws of one kind of element.

    Attributes:
        equations: of its samples, in the largest set of products.
        weights: of the powers of every input [-].
        lengths: shortest and longest [m].
        terms: number of products without the length that a weighted degree has, by degree.
    """

    equations: NormalEquations
    weights: np.ndarray
    lengths: tuple[float, float]
    terms: dict[float, int] = field(default_factory=dict)

    def supports(self, degree: float) -> bool:
        """Whether there are enough rows for the products of a degree."""
        return self._positions(degree).size <= self.equations.rows.sum() / ROWS

    def law(self, degree: float, without: int | None = None) -> ElementLaw:
        """The law of a weighted degree, without a fold of lines."""
        polynomial = self.equations.fit(self._positions(degree), without)
        return ElementLaw(polynomial=polynomial, lengths=self.lengths)

    def _positions(self, degree: float) -> np.ndarray:
        return chosen(self.equations.powers, self.weights, degree)


def candidates(
    samples: Sequence[Samples], fold_of: dict[int, int], tensions: np.ndarray, weights: np.ndarray, highest: float
) -> Candidates:
    """The laws of an element up to a weighted degree.

    Args:
        samples: of one length each, with their images.
        fold_of: of every line.
        tensions: lowest and highest of each, shape (t, 2) [N].
        weights: of tensions and wrench, shape (t + 6,).
        highest: weighted degree.
    """
    lengths = [one.length for one in samples]
    distinct = len(levels(np.array(lengths))[0])
    several = distinct > 1
    largest = MARGIN * np.max([np.abs(one.inputs).max(axis=0) for one in samples], axis=0)
    lower, upper = -largest, largest.copy()
    lower[: len(tensions)], upper[: len(tensions)] = tensions.T
    if several:
        weights = np.append(weights, 1.0)
        lower, upper = np.append(lower, min(lengths)), np.append(upper, max(lengths))
    powers = index_set(weights, highest)
    if several:
        powers = powers[powers[:, -1] <= min(LENGTH_POWERS, distinct - 1)]
    folds = max(fold_of.values()) + 1
    equations = NormalEquations(lower, upper, powers, folds, samples[0].values.shape[1])
    for one in samples:
        fold = np.array([fold_of[line] for line in one.lines.tolist()])
        if several:
            inputs = np.column_stack([one.inputs, np.full(len(one.inputs), one.length)])
            equations.add(inputs, one.values / one.length, one.jacobians / one.length, fold)
        else:
            equations.add(one.inputs, one.values, one.jacobians, fold)
    return Candidates(equations=equations, weights=weights, lengths=(min(lengths), max(lengths)))
