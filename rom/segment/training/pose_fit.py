"""The least-squares fit of poses by tensions and wrench, and the index set that predicts best what is left out.

A line is left out whole, images included, as its states are alike (rom.segment.training.regression).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rom.brief import brief
from rom.fit.chebyshev import Polynomial
from rom.segment.training.contact_error import relative_force_errors
from rom.segment.training.index_set import PURE_TERMS, index_set, pure_degree, tensions_alone
from rom.segment.training.regression import Samples, regression
from rom.snapshots.pressed_states import PressedStates
from rom.terminal import Progress, quiet

ROWS = 1.5  # rows a fit has at least for every coefficient [-]
FIRST_WEIGHTS = 1.25, 2.25  # of the force's and the moment's powers where the search begins; a tension's is 1 [-]
FORCES, MOMENTS = (0.8, 1.0, 1.25, 1.5), (1.5, 1.8, 2.25, 2.75)  # that are tried [-]
LOWEST, STEP = 2.0, 0.5  # weighted degree a search begins with, and by how much it grows
SHARE = 0.9  # quantile of the predicted states' errors by which fits are compared [-]


@brief
@dataclass(frozen=True, kw_only=True)
class PoseFit:
    """A fit, and how it predicts what it was not fitted to.

    Attributes:
        polynomial: of the inputs, 7 values.
        weights: of the powers of tensions, force and moment [-].
        degree: weighted total degree.
        left_out: relative error of every state's contact force, predicted without its line, shape (n,) [-]; nan of
            states without a force.
        left_out_places: error of every state's place, predicted likewise, shape (n,) [m].
    """

    polynomial: Polynomial
    weights: tuple[float, float, float]
    degree: float
    left_out: np.ndarray
    left_out_places: np.ndarray

    @property
    def score(self) -> float:
        """What is compared [-]."""
        return float(np.nanquantile(self.left_out, SHARE))


def best_fit(states: PressedStates, box: np.ndarray, terms: int, progress: Progress = quiet) -> PoseFit:
    """The fit with the best predictions of all with so many terms at most.

    The weighted degree grows while predictions become better; then other weights are tried, each at the degree that
    has as many terms.

    Args:
        states: with their images.
        box: lowest and highest of every input, shape (t + 6, 2).
        terms: most of them.
        progress: is told how many fits were made.
    """
    tried: dict[tuple[float, float], PoseFit] = {}
    total = len(FORCES) + len(MOMENTS) + 1

    def attempt(force: float, moment: float) -> PoseFit:
        if (force, moment) not in tried:
            progress("fitting poses", len(tried), total)
            tried[force, moment] = _largest(states, box, (1.0, force, moment), terms)
        return tried[force, moment]

    best = attempt(*FIRST_WEIGHTS)
    for moment in MOMENTS:
        best = min(best, attempt(best.weights[1], moment), key=lambda one: one.score)
    for force in FORCES:
        best = min(best, attempt(force, best.weights[2]), key=lambda one: one.score)
    progress("fitting poses", total, total)
    return best


def first_fit(states: PressedStates, box: np.ndarray, terms: int) -> PoseFit:
    """The fit with the weights that a search begins with: soon made, and seldom much worse; arguments of `best_fit`."""
    return _largest(states, box, (1.0, *FIRST_WEIGHTS), terms)


def supported(powers: np.ndarray, states: PressedStates, terms: int) -> bool:
    """Whether states have ROWS rows for every product, and ROWS rows at distinct tensions for those of tensions alone.

    Args:
        powers: of the products, shape (k, t + 6).
        states: with their images.
        terms: most products.
    """
    n, p = states.inputs.shape
    of_tensions = tensions_alone(powers, states.tensions)
    return len(powers) <= min(terms, n * (1 + p) / ROWS) and of_tensions <= states.tension_rows / ROWS


def _largest(states: PressedStates, box: np.ndarray, weights: tuple[float, float, float], terms: int) -> PoseFit:
    """The fit of the highest degree that the states support; the one before it if that predicts better."""
    pure = pure_degree(states.tensions, terms=min(PURE_TERMS, int(states.tension_rows / ROWS)))
    each = _each(weights, states.tensions)
    sets = [(LOWEST, index_set(each, LOWEST, states.tensions, pure))]
    for degree in np.arange(LOWEST + STEP, 40, STEP):
        grown = index_set(each, float(degree), states.tensions, pure)
        if not supported(grown, states, terms):
            break
        sets.append((float(degree), grown))
    last = [fit(states, box, powers, weights, degree) for degree, powers in sets[-2:]]
    return min(last, key=lambda one: one.score)


def _each(weights: tuple[float, float, float], tensions: int) -> np.ndarray:
    return np.repeat(weights, [tensions, 3, 3])


def fit(
    states: PressedStates, box: np.ndarray, powers: np.ndarray, weights: tuple[float, float, float], degree: float
) -> PoseFit:
    """The fit of the products of these powers, shape (k, t + 6)."""
    polynomial, poses = regression(Samples.of(states, states.poses, states.jacobians), box, powers)
    return PoseFit(
        polynomial=polynomial,
        weights=weights,
        degree=degree,
        left_out=relative_force_errors(states, poses),
        left_out_places=np.linalg.norm(poses[:, :3] - states.poses[:, :3], axis=1),
    )
