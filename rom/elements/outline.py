"""The outline of an element: where the corners of its cross-sections are, seen from its distal section.

At a distance from a section, which is one more input, this does not depend on how long the element is. The outline is
asked for by contact on the rubber, by pictures, and by displacements; it has fewer products than an element's law.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rom.brief import brief
from rom.elements.index_set import index_set
from rom.elements.regression import NormalEquations
from rom.elements.samples import Samples, own_samples
from rom.elements.section_states import SectionStates
from rom.elements.symmetry import mirrors, together
from rom.fit.chebyshev import Polynomial
from rom.snapshots.grid import SHARE, levels

CORNERS = np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])  # y and z of corners, over half the side [-]
NUMBERS = 3 * len(CORNERS)
DEGREE, WEIGHTS, ALONG = 4.0, (0.8, 1.5, 1.0), 0.8  # weighted degree; weights of the inputs, and of the distance [-]
MARGIN = 1.2  # the box is so much larger than the largest inputs: other fingers reach a little beyond these [-]
MOST_PAIRS = 30  # positions of one kind of element that are fitted


@brief
@dataclass(frozen=True, kw_only=True)
class OutlineLaw:
    """Corners of a cross-section by tensions, the wrench through the distal section, and the distance from that.

    Attributes:
        polynomial: of t + 7 inputs [N, N m, m]; of 12 values: how far the corners are from where they were at rest,
            seen from the distal section [m].
        half: of the section's side [m].
        error: of the corners in lines that were left out, 95th percentile [m].
    """

    polynomial: Polynomial
    half: float
    error: float

    @property
    def distances(self) -> tuple[float, float]:
        """Least and largest distance from the distal section [m]."""
        return float(self.polynomial.lower[-1]), float(self.polynomial.upper[-1])

    def corners(self, inputs: np.ndarray, distance: float) -> np.ndarray:
        """Corners at a distance towards the clamp [m], seen from the distal section, shape (n, 4, 3) [m].

        Args:
            inputs: tensions and wrench, shape (n, t + 6) [N, N m].
            distance: at rest; beyond the largest, the law goes on linearly.
        """
        known = np.column_stack([inputs, np.full(len(inputs), distance)])
        rest = np.column_stack([np.full(len(CORNERS), -distance), self.half * CORNERS])
        return np.asarray(rest + self.polynomial.value(known).reshape(-1, *rest.shape))

    def at(self, distance: float) -> Polynomial:
        """The polynomial of tensions and wrench at a distance [m], of the corners themselves, 12 values [m]."""
        law, (least, largest) = self.polynomial, self.distances
        angle = np.arccos(np.clip(2 * (distance - least) / (largest - least) - 1, -1.0, 1.0))
        shares = np.cos(law.powers[:, -1] * angle)
        powers, which = np.unique(law.powers[:, :-1], axis=0, return_inverse=True)
        coefficients = np.zeros((len(powers), NUMBERS))
        np.add.at(coefficients, which.ravel(), shares[:, None] * law.coefficients)
        rest = np.column_stack([np.full(len(CORNERS), -distance), self.half * CORNERS])
        coefficients[np.flatnonzero(~powers.any(axis=1))[0]] += rest.ravel()
        return replace(law, lower=law.lower[:-1], upper=law.upper[:-1], powers=powers, coefficients=coefficients)

    def scaled(self, size: float, modulus: float) -> OutlineLaw:
        """The law of an element `size` times as large, of rubber `modulus` times as stiff: exact by similarity."""
        law, force = self.polynomial, modulus * size**2
        inputs = np.full(len(law.lower), force)
        inputs[-4:-1], inputs[-1] = force * size, size
        scaled = replace(law, lower=law.lower * inputs, upper=law.upper * inputs, coefficients=law.coefficients * size)
        return OutlineLaw(polynomial=scaled, half=self.half * size, error=self.error * size)


def outline_samples(states: SectionStates, section: int, distal: int) -> Samples:
    """Corners of a cross-section seen from a body, the plate if `distal` is the number of cross-sections.

    A corner at y = c + R r is seen at R_d^T (y - c_d).
    """
    half = states.scene["geometry"]["side"] / 2
    near, far = states.sections[section], states.body(distal)
    own = states.corners[:, section] + np.column_stack([np.zeros(len(CORNERS)), half * CORNERS])
    relative = np.einsum("nji,njk->nik", far.rotations, near.rotations)
    place = np.einsum("nji,nj->ni", far.rotations, near.places - far.places)
    seen = place[:, None] + np.einsum("nij,nkj->nki", relative, own)
    # In the section's frame a corner moves by v + w x r + dr; seen from the body that moves, by what is left of it.
    moved = near.motions[:, None, :3] + np.cross(near.motions[:, None, 3:], own[..., None], axis=2)
    change = np.einsum("nij,nkjp->nkip", relative, moved + states.corner_changes[:, section])
    change -= far.motions[:, None, :3] + np.cross(far.motions[:, None, 3:], seen[..., None], axis=2)
    ends = np.append(states.at, states.length)
    rest = np.column_stack([np.full(len(CORNERS), ends[section] - ends[distal]), half * CORNERS])
    n, _, _, p = change.shape
    return own_samples(states, (section, distal), (seen - rest).reshape(n, -1), change.reshape(n, -1, p))


def _with_images(samples: Samples, states: SectionStates) -> Samples:
    """Samples of corners and their images: a map of the section exchanges its corners."""
    parts = [samples]
    for mirror in mirrors(states.scene):
        exchange = (CORNERS @ mirror.section.T)[:, None] == CORNERS[None]  # where each corner goes
        polar = mirror.inputs[states.tensions : states.tensions + 3, states.tensions : states.tensions + 3]
        parts.append(replace(mirror, values=np.kron(exchange.all(axis=2).T.astype(float), polar)).of(samples))
    return together(parts)


def train_outline(states: SectionStates, fold: np.ndarray, pairs: Sequence[tuple[int, int]]) -> OutlineLaw:
    """The outline of an element.

    Args:
        states: the states.
        fold: of each: lines that are left out together, shape (n,).
        pairs: cross-sections and the bodies that they are seen from.
    """
    chosen = [pairs[k] for k in np.unique(np.linspace(0, len(pairs) - 1, MOST_PAIRS).round().astype(int))]
    samples = [_with_images(outline_samples(states, *pair), states) for pair in chosen]
    distances = [one.length for one in samples]
    largest = MARGIN * np.max([np.abs(one.inputs).max(axis=0) for one in samples], axis=0)
    t = states.tensions
    lower, upper = np.append(-largest, min(distances)), np.append(largest, max(distances) * (1 + SHARE))
    lower[:t], upper[:t] = states.ranges.T
    powers = index_set(np.append(np.repeat(WEIGHTS, [t, 3, 3]), ALONG), DEGREE)
    powers = powers[powers[:, -1] < len(levels(np.array(distances))[0])]
    equations = NormalEquations(lower, upper, powers, int(fold.max()) + 1, NUMBERS)
    for one in samples:
        inputs = np.column_stack([one.inputs, np.full(len(one.inputs), one.length)])
        equations.add(inputs, one.values, one.jacobians, np.tile(fold, len(inputs) // len(fold)))
    every, off = np.arange(len(powers)), []
    for k in range(equations.folds):
        left_out = equations.fit(every, without=k)
        for one in samples:
            own = np.flatnonzero(fold == k)  # the samples themselves come before their images
            inputs = np.column_stack([one.inputs[own], np.full(len(own), one.length)])
            off.append(np.linalg.norm((left_out.value(inputs) - one.values[own]).reshape(-1, 3), axis=1))
    half = states.scene["geometry"]["side"] / 2
    error = float(np.quantile(np.concatenate(off), 0.95))
    return OutlineLaw(polynomial=equations.fit(every), half=half, error=error)
