"""The outline of an element: where the corners of its cross-sections are, seen from its distal section.

At a distance from a section, which is one more input, this does not depend on how long the element is. The outline is
asked for by contact on the rubber, by pictures, and by displacements; it has fewer products than an element's law.

The polynomial passes near the trained cross-sections, at even distances, and swings between them next to a plate or
the clamp (Runge 1901). So polynomials through the NEAREST of them give the corners in between.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rom.brief import brief
from rom.dataset.grid import SHARE, levels, nearest_weights
from rom.dataset.sections.plane_nodes import CORNERS
from rom.dataset.sections.section import extent, outline
from rom.elements.fitting.candidates import box, weights_of
from rom.elements.fitting.regression import NormalEquations, index_set
from rom.elements.law import combined, scales_of, wrench_scales
from rom.elements.polynomial import Polynomial
from rom.elements.samples.element_samples import Samples, own_samples
from rom.elements.samples.section_states import SectionStates
from rom.elements.samples.symmetry import Mirror
from rom.elements.samples.tension_map import TensionMap, of_scene

NUMBERS = 3 * len(CORNERS)
DEGREE, ALONG = 4.0, 0.4  # weighted degree; weight of the powers of the distance [-]
MOST = 1500  # products of an outline
STEP = 0.5  # by which the degree falls where it has more
MOST_PAIRS = 30  # positions of one kind of element that are fitted
PER_SIDE = 5  # intervals of cross-sections that determine the polynomial, at most, along the length of a side
NEAREST = 4  # cross-sections that interpolate one between them


@brief
@dataclass(frozen=True, kw_only=True)
class OutlineLaw:
    """Corners of a cross-section by loads, the wrench through the distal section, and the distance from that.

    Attributes:
        tension_map: orthogonal; the first t inputs of the polynomial are tension_map @ loads, shape (t, t).
        tensions: lowest and highest loads, shape (2, t) [N, Pa].
        polynomial: of t + 7 inputs [N, Pa, N m, m]; of 12 values: how far the corners are from where they were at rest,
            seen from the distal section [m].
        half: of the section's box along y and z, shape (2,) [m].
        error: of the corners in lines that were left out, 95th percentile; or on a finer mesh, if it is larger [m].
        pressures: how many of the loads are pressures, the last ones.
    """

    tension_map: np.ndarray
    tensions: np.ndarray
    polynomial: Polynomial
    half: np.ndarray
    error: float
    pressures: int = 0

    @property
    def distances(self) -> tuple[float, float]:
        """Least and largest distance from the distal section [m]."""
        return float(self.polynomial.lower[-1]), float(self.polynomial.upper[-1])

    @property
    def cross_sections(self) -> np.ndarray:
        """Even distances of as many cross-sections as determine the distance's polynomial, shape (m,) [m]."""
        return np.linspace(*self.distances, int(self.polynomial.powers[:, -1].max()) + 1)

    def corners(self, inputs: np.ndarray, distance: float) -> np.ndarray:
        """Corners at a distance towards the clamp [m], seen from the distal section, shape (n, 4, 3) [m].

        Args:
            inputs: tensions and wrench, shape (n, t + 6) [N, N m].
            distance: at rest, within `distances`.
        """
        return self.at(distance).value(combined(inputs, self.tension_map)).reshape(-1, len(CORNERS), 3)

    def at(self, distance: float) -> Polynomial:
        """The polynomial of combinations of tensions and the wrench at a distance [m]: the corners, 12 values [m]."""
        law, (least, largest), trained = self.polynomial, self.distances, self.cross_sections
        (first,), (weights,) = nearest_weights(trained, np.array([distance]), NEAREST)
        near = trained[first : first + len(weights)]
        angles = np.arccos(np.clip(2 * (near - least) / (largest - least) - 1, -1.0, 1.0))
        shares = np.cos(np.outer(law.powers[:, -1], angles)) @ weights
        powers, which = np.unique(law.powers[:, :-1], axis=0, return_inverse=True)
        coefficients = np.zeros((len(powers), NUMBERS))
        np.add.at(coefficients, which.ravel(), shares[:, None] * law.coefficients)
        rest = np.column_stack([np.full(len(CORNERS), -distance), self.half * CORNERS])
        found = replace(law, lower=law.lower[:-1], upper=law.upper[:-1], powers=powers, coefficients=coefficients)
        unloaded = found.value(np.zeros((1, powers.shape[1])))[0]  # what the fit leaves of no motion
        coefficients[np.flatnonzero(~powers.any(axis=1))[0]] += rest.ravel() - unloaded
        return found

    def scaled(self, size: float, modulus: float) -> OutlineLaw:
        """The law of an element `size` times as large, of rubber `modulus` times as stiff: exact by similarity."""
        law, loads = self.polynomial, scales_of(self.tensions.shape[1], self.pressures, size, modulus)
        inputs = np.concatenate([loads, wrench_scales(size, modulus), [size]])
        scaled = replace(law, lower=law.lower * inputs, upper=law.upper * inputs, coefficients=law.coefficients * size)
        return replace(
            self,
            tensions=self.tensions * loads,
            polynomial=scaled,
            half=self.half * size,
            error=self.error * size,
        )


def outline_samples(states: SectionStates, section: int, distal: int) -> Samples:
    """Corners of a cross-section seen from a body, the plate if `distal` is the number of cross-sections.

    A corner at y = c + R r is seen at R_d^T (y - c_d).
    """
    half = outline(states.scene).box
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


def _images(states: SectionStates, tension_map: TensionMap) -> list[Mirror]:
    """The mirrors of a finger, which exchange the corners of its cross-sections."""
    images, t = [], states.tensions
    for mirror in states.mirrors:
        exchange = ((CORNERS @ mirror.section.T)[:, None] == CORNERS[None]).all(axis=2)  # the image of each corner
        polar = mirror.inputs[t : t + 3, t : t + 3]
        values = np.kron(exchange.T.astype(float), polar)
        images.append(replace(mirror.combined(tension_map).with_length(), values=values))
    return images


def train_outline(
    states: SectionStates, fold: np.ndarray, pairs: Sequence[tuple[int, int]], finer: SectionStates | None = None
) -> OutlineLaw:
    """The outline of an element.

    Args:
        states: the states.
        fold: of each: lines that are left out together, shape (n,).
        pairs: cross-sections and the bodies that they are seen from.
        finer: states on a finer mesh, at the same cross-sections, by which the error is estimated.
    """
    chosen = [pairs[k] for k in np.unique(np.linspace(0, len(pairs) - 1, MOST_PAIRS).round().astype(int))]
    samples = [outline_samples(states, *pair) for pair in chosen]
    tension_map = of_scene(states.scene)
    images = _images(states, tension_map)
    equations = _equations(states, samples, tension_map, images, int(fold.max()) + 1)
    inputs = [_along(one, tension_map.matrix) for one in samples]
    for one, known in zip(samples, inputs, strict=True):
        equations.add(known, one.values, combined(one.jacobians, tension_map.matrix), fold)
    equations.add_images(images)
    every, off = np.arange(len(equations.powers)), []
    for k in range(equations.folds):
        left_out, own = equations.fit(every, [k]), fold == k
        for one, known in zip(samples, inputs, strict=True):
            off.append(_distances(left_out, known[own], one.values[own]))
    law, errors = equations.fit(every), [off]
    if finer is not None:
        samples = [outline_samples(finer, *pair) for pair in chosen]
        errors.append([_distances(law, _along(one, tension_map.matrix), one.values) for one in samples])
    return OutlineLaw(
        tension_map=tension_map.matrix,
        tensions=states.ranges.T,
        polynomial=law,
        half=outline(states.scene).box,
        error=max(float(np.quantile(np.concatenate(one), 0.95)) for one in errors),
        pressures=states.pressures,
    )


def _distances(law: Polynomial, inputs: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Distances of corners from those of a law, shape (4 n,) [m]."""
    return np.linalg.norm((law.value(inputs) - values).reshape(-1, 3), axis=1)


def _along(samples: Samples, tension_map: np.ndarray) -> np.ndarray:
    """Inputs of an outline's polynomial, shape (n, t + 7)."""
    return np.column_stack([combined(samples.inputs, tension_map), np.full(len(samples.inputs), samples.length)])


def _equations(
    states: SectionStates, samples: Sequence[Samples], tension_map: TensionMap, images: Sequence[Mirror], folds: int
) -> NormalEquations:
    """Normal equations of the highest degree, up to DEGREE, with MOST products at most."""
    distances, degree = [one.length for one in samples], DEGREE
    lower, upper = box(samples, tension_map.matrix, states.ranges.T, images)
    lower, upper = np.append(lower, min(distances)), np.append(upper, max(distances) * (1 + SHARE))
    weights, several = np.append(weights_of(tension_map), ALONG), len(levels(np.array(distances))[0])
    several = min(several, 1 + round(PER_SIDE * np.ptp(distances) / extent(states.scene)))
    while True:
        powers = index_set(weights, degree)
        powers = powers[powers[:, -1] < several]
        if len(powers) <= MOST:
            return NormalEquations(lower, upper, powers, folds, NUMBERS)
        degree -= STEP
