"""The law of an element: what it does under tensions and the wrench that it transmits."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rom.brief import brief
from rom.checked_file import ModelError
from rom.fit.chebyshev import Polynomial
from rom.snapshots.grid import SHARE

POSE = 6  # first values of a law: place [m], Rodrigues vector [-]


@brief
@dataclass(frozen=True, kw_only=True)
class ElementLaw:
    """A polynomial of tensions [N] and the wrench through the distal section, in that section's frame [N, N m].

    Its values are the pose of the proximal section seen from the distal one, place [m] and Rodrigues vector [-], then
    how much shorter every tendon has become in the element [m]. A law of several lengths has the length as its last
    input [m], and its values are per length.

    Attributes:
        polynomial: of t + 6 inputs, or t + 7; of 6 + t values.
        lengths: shortest and longest at rest that were trained [m]; equal in a law of one length.
    """

    polynomial: Polynomial
    lengths: tuple[float, float]

    @property
    def has_lengths(self) -> bool:
        """Whether it is a law of several lengths."""
        return self.lengths[0] < self.lengths[1]

    def of_length(self, length: float) -> Polynomial:
        """The polynomial of an element of a length at rest [m], by tensions and wrench.

        Below the shortest length the values per length stay: they are those of a section.

        Raises:
            ModelError: a length beyond those of the law.
        """
        law, (shortest, longest) = self.polynomial, self.lengths
        slack = SHARE * longest
        if not (0 if self.has_lengths else shortest - slack) <= length <= longest + slack:
            bound = f"from 0 to {longest:.6g}" if self.has_lengths else f"{longest:.6g}"
            raise ModelError(f"length must be {bound} m, got {length:.6g}")
        if not self.has_lengths:
            return law
        angle = np.arccos(np.clip(2 * (length - shortest) / (longest - shortest) - 1, -1.0, 1.0))
        shares = length * np.cos(law.powers[:, -1] * angle)
        powers, which = np.unique(law.powers[:, :-1], axis=0, return_inverse=True)
        coefficients = np.zeros((len(powers), law.coefficients.shape[1]))
        np.add.at(coefficients, which.ravel(), shares[:, None] * law.coefficients)
        return replace(law, lower=law.lower[:-1], upper=law.upper[:-1], powers=powers, coefficients=coefficients)

    def scaled(self, size: float, modulus: float) -> ElementLaw:
        """The law of an element `size` times as large, of rubber `modulus` times as stiff: exact by similarity.

        Forces go with the modulus and an area, moments with another length, places and lengths with the size.
        """
        law, force = self.polynomial, modulus * size**2
        inputs = np.full(len(law.lower), force)
        values = np.full(law.coefficients.shape[1], size)
        values[3:POSE] = 1.0
        tensions = len(values) - POSE
        inputs[tensions + 3 : tensions + 6] = force * size
        if self.has_lengths:
            inputs[-1], values = size, values / size
        scaled = replace(
            law, lower=law.lower * inputs, upper=law.upper * inputs, coefficients=law.coefficients * values
        )
        return ElementLaw(polynomial=scaled, lengths=(self.lengths[0] * size, self.lengths[1] * size))
