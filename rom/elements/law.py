"""The law of an element: what it does under its actuators' loads and the wrench that it transmits.

Loads are tensions of tendons [N], then pressures of chambers [Pa], in every array that is named after tensions. The
strokes that they do work on are shortenings of tendons [m], then growths of chambers [m^3]. A law is of any length
within its range; at one length it is an element's map.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rom.brief import brief
from rom.dataset.grid import SHARE
from rom.elements.polynomial import Polynomial
from rom.files.checked_file import ModelError

POSE = 6  # first values of a law: place [m], Rodrigues vector [-]


@brief
@dataclass(frozen=True, kw_only=True)
class ElementMap:
    """(t loads [N, Pa], wrench through the distal section [N, N m]) -> values, as of an element of one length.

    Attributes:
        tension_map: the first m inputs of the polynomial are tension_map @ tensions, shape (m, t).
        tensions: lowest and highest, shape (2, t) [N].
        polynomial: of m + 6 inputs.
        deviations: of the variants' poses, of the same inputs, 6 values each, see `ElementLaw`; None if there are none.
    """

    tension_map: np.ndarray
    tensions: np.ndarray
    polynomial: Polynomial
    deviations: Polynomial | None = None

    def deviation(self, inputs: np.ndarray) -> np.ndarray:
        """Deviations of the variants' poses, shape (n, variants, 6) [m, -]; beyond the box at its nearest point."""
        if self.deviations is None:
            return np.zeros((len(inputs), 0, POSE))
        own = np.clip(combined(inputs, self.tension_map), self.deviations.lower, self.deviations.upper)
        return self.deviations.value(own).reshape(len(inputs), -1, POSE)

    def value(self, inputs: np.ndarray) -> np.ndarray:
        """Values, shape (n, values), at tensions and wrenches, shape (n, t + 6)."""
        return self.polynomial.value(combined(inputs, self.tension_map))

    def value_and_gradient(self, inputs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Values, shape (n, values), and derivatives by tensions and wrench, shape (n, values, t + 6)."""
        values, gradient = self.polynomial.value_and_gradient(combined(inputs, self.tension_map))
        return values, combined(gradient, self.tension_map.T)

    def on(self, tensions: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> ElementMap:
        """The map in a smaller box of tensions, shape (2, t) [N], and of their combinations, shapes (m,) [N]."""
        parts = (self.polynomial, self.deviations)
        polynomial, deviations = (None if one is None else on_tensions(one, lower, upper) for one in parts)
        assert polynomial is not None
        return replace(self, tensions=tensions, polynomial=polynomial, deviations=deviations)

    def only(self, tensions: Sequence[int]) -> ElementMap:
        """The map by some of its tensions, shape (k,), which may repeat each other, where all others are 0 N."""
        kept = list(tensions)
        return replace(self, tension_map=self.tension_map[:, kept], tensions=self.tensions[:, kept])


def scales_of(loads: int, pressures: int, size: float, modulus: float) -> np.ndarray:
    """Ratios of loads in a similar finger, the last ones of pressures, shape (loads,) [-]."""
    return np.repeat([modulus * size**2, modulus], [loads - pressures, pressures])


def wrench_scales(size: float, modulus: float) -> np.ndarray:
    """Ratios of a wrench's components in a similar finger, shape (6,) [-]."""
    return np.repeat([modulus * size**2, modulus * size**3], 3)


def on_tensions(polynomial: Polynomial, lower: np.ndarray, upper: np.ndarray) -> Polynomial:
    """A polynomial in another box of its first inputs, combinations of tensions, shapes (m,) [N]."""
    m = len(lower)
    return polynomial.on(np.append(lower, polynomial.lower[m:]), np.append(upper, polynomial.upper[m:]))


def combined(inputs: np.ndarray, tension_map: np.ndarray) -> np.ndarray:
    """Inputs with tension_map @ tensions in place of the tensions, shapes (..., t + more), (..., m + more).

    Derivatives by the combinations become those by the tensions by the transposed map.
    """
    t = tension_map.shape[1]
    return np.concatenate([inputs[..., :t] @ tension_map.T, inputs[..., t:]], axis=-1)


@brief
@dataclass(frozen=True, kw_only=True)
class ElementLaw:
    """A polynomial of combinations of loads [N, Pa] and the wrench through the distal section, in its frame [N, N m].

    Its values are the pose of the proximal section seen from the distal one, place [m] and Rodrigues vector [-], then
    the strokes of all actuators in the element [m, m^3]. A law of several lengths has the length as its last input [m],
    and its values are per length.

    Attributes:
        tension_map: orthogonal; the first t inputs of the polynomial are tension_map @ loads, shape (t, t). It combines
            tensions with tensions and pressures with pressures.
        tensions: lowest and highest loads, shape (2, t) [N, Pa].
        polynomial: of t + 6 inputs, or t + 7; of 6 + t values.
        lengths: shortest and longest at rest that were trained [m]; equal in a law of one length.
        deviations: by how much the poses of variants of the law differ from its own, 6 values for each, of the same
            inputs. The squares of what they do to an answer add up to that of its estimated error. None: not known.
        pressures: how many of the loads are pressures, the last ones.
    """

    tension_map: np.ndarray
    tensions: np.ndarray
    polynomial: Polynomial
    lengths: tuple[float, float]
    deviations: Polynomial | None = None
    pressures: int = 0

    @property
    def has_lengths(self) -> bool:
        """True if the law is one of several lengths."""
        return self.lengths[0] < self.lengths[1]

    def of_length(self, length: float) -> ElementMap:
        """The map of an element of a length at rest [m].

        Below the shortest length the values per length stay: they are those of a section.

        Raises:
            ModelError: a length beyond those of the law.
        """
        shortest, longest = self.lengths
        slack = SHARE * longest
        if not (0 if self.has_lengths else shortest - slack) <= length <= longest + slack:
            bound = f"from 0 to {longest:.6g}" if self.has_lengths else f"{longest:.6g}"
            raise ModelError(f"length must be {bound} m, got {length:.6g}")
        return ElementMap(
            tension_map=self.tension_map,
            tensions=self.tensions,
            polynomial=self._of_length(self.polynomial, length),
            deviations=None if self.deviations is None else self._of_length(self.deviations, length),
        )

    def _of_length(self, law: Polynomial, length: float) -> Polynomial:
        """A polynomial of the law's inputs at one length [m]."""
        if not self.has_lengths:
            return law
        shortest, longest = self.lengths
        angle = np.arccos(np.clip(2 * (length - shortest) / (longest - shortest) - 1, -1.0, 1.0))
        shares = length * np.cos(law.powers[:, -1] * angle)
        powers, which = np.unique(law.powers[:, :-1], axis=0, return_inverse=True)
        coefficients = np.zeros((len(powers), law.coefficients.shape[1]))
        np.add.at(coefficients, which.ravel(), shares[:, None] * law.coefficients)
        return replace(law, lower=law.lower[:-1], upper=law.upper[:-1], powers=powers, coefficients=coefficients)

    def scaled(self, size: float, modulus: float) -> ElementLaw:
        """The law of an element `size` times as large, of rubber `modulus` times as stiff: exact by similarity.

        Forces go with the modulus and an area, moments with another length, pressures with the modulus, places and
        lengths with the size, volumes with its cube.
        """
        loads = scales_of(self.tensions.shape[1], self.pressures, size, modulus)
        inputs = np.concatenate([loads, wrench_scales(size, modulus), [size] * int(self.has_lengths)])
        values = np.concatenate(
            [np.repeat([size, 1.0], 3), modulus * size**3 / loads]
        )  # the work of a load is a stroke's
        if self.has_lengths:
            values = values / size

        def scaled(law: Polynomial) -> Polynomial:
            units = np.resize(values[:POSE], law.coefficients.shape[1]) if law is self.deviations else values
            ends = {"lower": law.lower * inputs, "upper": law.upper * inputs}
            return replace(law, coefficients=law.coefficients * units, **ends)

        return replace(
            self,
            tensions=self.tensions * loads,
            polynomial=scaled(self.polynomial),
            lengths=(self.lengths[0] * size, self.lengths[1] * size),
            deviations=None if self.deviations is None else scaled(self.deviations),
        )
