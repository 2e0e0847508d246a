"""The paper's separated form of the same map, in eight parameters: terms against error.

Pose = sum_r v_r prod_i g_ri(z_i), by alternating least squares on the coefficients of the polynomial that the map is,
in Chebyshev polynomials of every input. Terms are added in rounds, as the paper enriches its sums.
"""

from __future__ import annotations

import numpy as np

from rom.error_statistics import quantiles
from rom.fit.chebyshev import products
from rom.rod.rod import Rod
from rom.segment.training.contact_error import relative_force_errors
from rom.snapshots.pressed_states import read_pressed_states
from studies.runner import Run
from studies.segment import maps

TURN = 0.01  # of a quaternion's error, which counts as one of place [m]: it moves corners by some half a side
SWEEPS = 60  # over all factors, after every round
RIDGE = 1e-12  # of the normal equations' trace [-]


class Separated:
    """A sum of products of functions of one input each.

    Args:
        segment: the map.
    """

    def __init__(self, segment: Rod):
        self._pose, self._powers = segment.pose, segment.pose.powers
        self._weights = np.array([1.0] * 3 + [TURN] * 4)
        # Chebyshev polynomials of one input are orthogonal, T_0 twice as long: in these coefficients, norms are sums.
        halves = np.sqrt(0.5) ** (self._powers > 0)
        self._scale = halves.prod(axis=1)
        self._values = segment.pose.coefficients * self._scale[:, None] * self._weights
        self._random = np.random.default_rng(0)
        self.factors = [np.zeros((most + 1, 0)) for most in self._powers.max(axis=0)]
        self.vectors = np.zeros((7, 0))

    @property
    def numbers(self) -> int:
        """How many it is made of."""
        return sum(factor.size for factor in self.factors) + self.vectors.size

    def enrich(self, terms: int) -> None:
        """Have so many terms, and alternate."""
        more = terms - self.vectors.shape[1]
        self.factors = [np.hstack([one, self._random.standard_normal((len(one), more))]) for one in self.factors]
        self.vectors = np.hstack([self.vectors, 1e-3 * np.abs(self._values).max() * np.ones((7, more))])
        for _ in range(SWEEPS):
            self._sweep()

    def _sweep(self) -> None:
        rows = [factor[power] for factor, power in zip(self.factors, self._powers.T, strict=True)]
        grams = [factor.T @ factor for factor in self.factors]
        for i, factor in enumerate(self.factors):
            others = np.prod([row for j, row in enumerate(rows) if j != i], axis=0)
            gram = np.prod([one for j, one in enumerate(grams) if j != i], axis=0) * (self.vectors.T @ self.vectors)
            right = np.zeros_like(factor)
            np.add.at(right, self._powers[:, i], others * (self._values @ self.vectors))
            found = self._solve(gram, right.T).T
            size = np.linalg.norm(found, axis=0)
            self.factors[i] = found / np.where(size > 0, size, 1.0)
            self.vectors = self.vectors * size
            rows[i], grams[i] = self.factors[i][self._powers[:, i]], self.factors[i].T @ self.factors[i]
        together = np.prod(rows, axis=0)
        self.vectors = self._solve(np.prod(grams, axis=0), together.T @ self._values).T

    @staticmethod
    def _solve(gram: np.ndarray, right: np.ndarray) -> np.ndarray:
        return np.asarray(np.linalg.solve(gram + RIDGE * np.trace(gram) * np.eye(len(gram)), right))

    def poses(self, inputs: np.ndarray) -> np.ndarray:
        """At inputs, shape (n, 8); shape (n, 7)."""
        pose = self._pose
        scaled = 2 * (inputs - pose.lower) / (pose.upper - pose.lower) - 1
        found = np.ones((len(inputs), self.vectors.shape[1]))
        for i, factor in enumerate(self.factors):
            alone = np.zeros((len(factor), scaled.shape[1]), int)
            alone[:, i] = np.arange(len(factor))
            lengths = np.sqrt(0.5) ** (alone[:, i] > 0)
            found *= products(scaled, alone) @ (factor / lengths[:, None])
        return np.asarray((found @ self.vectors.T) / self._weights)


def row(run: Run, plan: maps.Plan, rounds: tuple[int, ...]) -> dict:
    """The map, and its separated forms."""
    segment, held_out = maps.segment(run, plan), read_pressed_states(maps.held_out(run, plan))
    whole, _ = segment.pose.value_and_gradient(held_out.inputs)
    separated, forms = Separated(segment), []
    for terms in rounds:
        separated.enrich(terms)
        errors = relative_force_errors(held_out, separated.poses(held_out.inputs))
        forms.append({"terms": terms, "numbers": separated.numbers, "error": quantiles(errors)})
    return {
        "products": len(segment.pose.powers),
        "numbers": segment.pose.coefficients.size,
        "error": quantiles(relative_force_errors(held_out, whole)),
        "forms": forms,
    }


def measure(run: Run) -> dict:
    """Of the small map."""
    plan, rounds = (maps.QUICK, (20, 40)) if run.quick else (maps.SMALL, (50, 100, 200, 400))
    return run.once("separated forms", row, run, plan, rounds)
