"""The laws that an element's samples support: one regression, of which every set of fewer products is a part."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rom.brief import brief
from rom.dataset.actuators import actuators_of, pressures_of
from rom.dataset.grid import levels
from rom.elements.fitting.regression import NormalEquations, chosen, index_set
from rom.elements.law import POSE, ElementLaw, combined
from rom.elements.polynomial import Polynomial
from rom.elements.samples.element_samples import Samples
from rom.elements.samples.symmetry import Mirror
from rom.elements.samples.tension_map import TensionMap, of_scene

# Weights of powers, measured [-]: of combinations of tensions by the order of their moment, and of higher ones; of a
# wrench's force and moment.
BY_ORDER, HIGHER, WRENCH = (0.8, 0.8, 1.25), 2.0, (2.0, 1.0)
MOST = 3000  # products of a regression: bounds memory and time
STEP = 0.5  # between weighted degrees that are tried [-]
ROWS = 1.5  # rows a fit has at least for every coefficient [-]
LENGTH_POWERS = 3  # highest degree in the length
VARIANTS = 7  # fits without a group of lines, at most: their spread is the estimated error of the fit
REMAINING = 0.25  # of what a finer mesh corrects, that is left as an error: no mesh is fine enough [-]
MARGIN = 1.2  # the box is so much larger than the largest wrench: other fingers reach a little beyond these [-]


@brief
@dataclass(frozen=True, kw_only=True)
class Candidates:
    """Laws of one kind of element.

    Attributes:
        equations: of its samples, in the largest set of products.
        tension_map: its variables in place of loads, shape (t, t).
        tensions: lowest and highest loads, shape (2, t) [N, Pa].
        weights: of the powers of every input [-].
        lengths: shortest and longest [m].
        highest: weighted degree of the largest set.
        images: mirrors of the samples, by the equations' inputs.
        corrected: the law that these correct, with its variants; None if they stand alone.
        pressures: how many of the loads are pressures, the last ones.
    """

    equations: NormalEquations
    tension_map: np.ndarray
    tensions: np.ndarray
    weights: np.ndarray
    lengths: tuple[float, float]
    highest: float
    images: Sequence[Mirror]
    corrected: ElementLaw | None = None
    pressures: int = 0

    def supports(self, degree: float) -> bool:
        """True if all products of a degree are candidates, and rows are enough for them."""
        return degree <= self.highest and self._positions(degree).size <= self.equations.rows.sum() / ROWS

    def law(self, degree: float, without: int | None = None) -> ElementLaw:
        """The law of a weighted degree, without a fold of lines."""
        law_of_set = self._law(self.equations.fit(self._positions(degree), _left_out(without)))
        if self.corrected is None:
            return law_of_set
        base = self.corrected  # whole: the lines that correct it are not those that it was fitted to
        return replace(base, polynomial=base.polynomial.plus(law_of_set.polynomial), deviations=None)

    def with_variants(self, degree: float) -> ElementLaw:
        """The law of a weighted degree, and by how much those without a group of lines deviate from it.

        Those of a corrected law are both varied at once; what corrects it is one more variant, times REMAINING.
        """
        folds = list(range(self.equations.folds))
        groups, positions = [folds[k::VARIANTS] for k in range(min(VARIANTS, len(folds)))], self._positions(degree)
        deviations = self.equations.deviations(positions, groups, POSE)
        if self.corrected is not None:
            base = self.corrected.deviations
            assert base is not None
            few = base.coefficients.shape[1] - deviations.coefficients.shape[1]  # of fewer lines there are fewer groups
            padded = replace(deviations, coefficients=np.pad(deviations.coefficients, [(0, 0), (0, few)]))
            correction = self.equations.fit(positions)
            remaining = replace(correction, coefficients=REMAINING * correction.coefficients[:, :POSE])
            deviations = Polynomial.together([base.plus(padded), remaining])
        single = deviations.coefficients.astype(np.float32).astype(float)  # as a file and compiled code hold them
        return replace(self.law(degree), deviations=replace(deviations, coefficients=single))

    def _law(self, polynomial: Polynomial) -> ElementLaw:
        return ElementLaw(
            tension_map=self.tension_map,
            tensions=self.tensions,
            polynomial=polynomial,
            lengths=self.lengths,
            pressures=self.pressures,
        )

    def _positions(self, degree: float) -> np.ndarray:
        return chosen(self.equations.powers, self.weights, degree)


def _left_out(fold: int | None) -> list[int]:
    return [] if fold is None else [fold]


def candidates(
    samples: Sequence[Samples],
    fold_of: dict[int, int],
    scene: dict[str, Any],
    mirrors: Sequence[Mirror],
    highest: float,
) -> Candidates:
    """The laws of an element up to a weighted degree.

    Args:
        samples: of one length each.
        fold_of: of every line.
        scene: of the finger, as plain data.
        mirrors: of the samples.
        highest: weighted degree; a lower one if it has more than MOST products.
    """
    lengths = [one.length for one in samples]
    distinct = len(levels(np.array(lengths))[0])
    several = distinct > 1
    tension_map = of_scene(scene)
    images = [mirror.combined(tension_map) for mirror in mirrors]
    tensions = np.array([(one.lower, one.upper) for one in actuators_of(scene)]).T
    lower, upper = box(samples, tension_map.matrix, tensions, images)
    weights = weights_of(tension_map)
    if several:
        weights = np.append(weights, 1.0)
        lower, upper = np.append(lower, min(lengths)), np.append(upper, max(lengths))
        images = [mirror.with_length() for mirror in images]
    most_lengths = min(LENGTH_POWERS, distinct - 1) if several else None
    while len(powers := _products(weights, highest, most_lengths)) > MOST:
        highest -= STEP
    equations = NormalEquations(lower, upper, powers, max(fold_of.values()) + 1, samples[0].values.shape[1])
    rows = [rows_of(one, tension_map.matrix, several) for one in samples]
    fold = np.array([fold_of[line] for one in samples for line in one.lines.tolist()])
    inputs, values, jacobians = (np.concatenate(part) for part in zip(*rows, strict=True))
    equations.add(inputs, values, jacobians, fold)
    equations.add_images(images)
    return Candidates(
        equations=equations,
        tension_map=tension_map.matrix,
        tensions=tensions,
        weights=weights,
        lengths=(min(lengths), max(lengths)) if several else (lengths[0], lengths[0]),
        highest=highest,
        pressures=pressures_of(scene),
        images=images,
    )


def rows_of(samples: Samples, tension_map: np.ndarray, by_length: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Inputs, values and derivatives of samples by combinations of tensions; per length where that is an input."""
    inputs, jacobians = (combined(part, tension_map) for part in (samples.inputs, samples.jacobians))
    if not by_length:
        return inputs, samples.values, jacobians
    inputs = np.column_stack([inputs, np.full(len(inputs), samples.length)])
    return inputs, samples.values / samples.length, jacobians / samples.length


def _products(weights: np.ndarray, degree: float, most_lengths: int | None) -> np.ndarray:
    """Powers of all products of a degree, shape (k, inputs); of the length, the last input, up to one of its own."""
    powers = index_set(weights, degree)
    return powers if most_lengths is None else powers[powers[:, -1] <= most_lengths]


def weights_of(tension_map: TensionMap) -> np.ndarray:
    """Weights of the powers of combinations of tensions and of a wrench, shape (t + 6,)."""
    return np.append(np.append(BY_ORDER, HIGHER)[tension_map.orders.clip(max=len(BY_ORDER))], np.repeat(WRENCH, 3))


def box(
    samples: Sequence[Samples], tension_map: np.ndarray, tensions: np.ndarray, images: Sequence[Mirror]
) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper ends of combinations and wrenches, shapes (t + 6,); a mirror makes the same box of it."""
    t = len(tension_map)
    ranges = np.sort(tension_map[:, :, None] * tensions.T, axis=2).sum(axis=1)
    largest = MARGIN * np.max([np.abs(one.inputs[:, t:]).max(axis=0) for one in samples], axis=0)
    largest = np.max([largest, *(np.abs(mirror.inputs[t : t + 6, t : t + 6]) @ largest for mirror in images)], axis=0)
    return np.append(ranges[:, 0], -largest), np.append(ranges[:, 1], largest)
