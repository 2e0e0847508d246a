"""Loss of a law's stability: the stretch at which more strain no longer needs more stress.

Hill's inequality, which commercial codes check as Drucker's stability: every change of the logarithmic strain e does
positive work on the change of the Kirchhoff stress tau that it makes. With the energy as a function of the principal
logarithmic strains, tau_i = dW/de_i, this holds where

    d2W/de_i de_j is positive definite, and (tau_i - tau_j) / (e_i - e_j) > 0 for every pair.

(Hill, J. Mech. Phys. Solids 16, 1968, doi:10.1016/0022-5096(68)90031-8.)
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from fingerfem.scene.laws.formula import NUMPY, Invariants

if TYPE_CHECKING:
    from fingerfem.scene.laws.law import Law

# Which principal directions are stretched, and which are free; the second one of planar stretch keeps its length.
MODES = {
    "uniaxial": (np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 1.0])),
    "equibiaxial": (np.array([1.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])),
    "planar": (np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])),
}
STEPS, ITERATIONS, SETTLED = 40, 50, 1e-14  # along a path; of Newton's method for what is free, and its last step [-]
FARTHEST = 2.0  # largest step of a free logarithmic strain that stays on the path [-]
HALVINGS = 40  # of the step in which stability is lost
EQUAL = 1e-5  # principal strains that differ by less count as equal [-]
IMAGINARY, STEP = 1e-30, 1e-5  # of first derivatives, which are exact; of differences of those [-]


def stress(law: Law, e: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Principal Kirchhoff stresses at principal logarithmic strains, shape (3,), and their derivatives, (3, 3) [Pa]."""

    def distortional_stress(e: np.ndarray) -> np.ndarray:
        """The same of the distortional energy alone, shapes (n, 3)."""
        C = np.exp(2 * (e[:, None] + 1j * IMAGINARY * np.eye(3)))
        I2 = C[..., 0] * C[..., 1] + C[..., 1] * C[..., 2] + C[..., 2] * C[..., 0]
        strain = Invariants(C.sum(axis=-1), I2, np.sqrt(C.prod(axis=-1)))
        return np.imag(law.distortional(strain, NUMPY)) / IMAGINARY

    def pressure(J: float) -> float:
        """U'(J) [Pa]."""
        energy = law.volumetric(J + 1j * IMAGINARY, NUMPY)
        return 0.0 if energy is None else float(np.imag(energy)) / IMAGINARY

    nearby = distortional_stress(e + np.concatenate([np.zeros((1, 3)), STEP * np.eye(3), -STEP * np.eye(3)]))
    J = float(np.exp(e.sum()))
    p, slope = pressure(J), (pressure(J + STEP) - pressure(J - STEP)) / (2 * STEP)
    derivatives = (nearby[1:4] - nearby[4:]) / (2 * STEP)
    return nearby[0] + J * p, (derivatives + derivatives.T) / 2 + J * p + J**2 * slope


def margin(law: Law, e: np.ndarray) -> float:
    """The least work of a unit strain at principal logarithmic strains [Pa]; above 0 where the law is stable."""
    tau, slope = stress(law, e)
    shears = [
        (tau[i] - tau[j]) / (e[i] - e[j]) if abs(e[i] - e[j]) > EQUAL else slope[i, i] - slope[i, j]
        for i, j in combinations(range(3), 2)
    ]
    return float(min(np.linalg.eigvalsh(slope)[0], *shears))


def ends(mode: str, stretches: tuple[float, float]) -> tuple[float, float]:
    """Ends of a mode's path, at the lowest or highest principal stretch of incompressible rubber [-]."""
    low, high = stretches
    if mode == "uniaxial":
        return max(low, high**-2), min(high, low**-2)
    if mode == "equibiaxial":
        return max(low, high**-0.5), min(high, low**-0.5)
    return max(low, 1 / high), min(high, 1 / low)


def loss(law: Law, mode: str, stretches: tuple[float, float]) -> float | None:
    """The stretch nearest to 1 at which stability is lost on the path of a mode [-]; None if it is not."""
    stretched, free = MODES[mode]

    def along(x: float, start: float) -> tuple[float, float]:
        """The margin at a strain x, and the strain of what is free, near to `start`."""
        own = start
        for _ in range(ITERATIONS):
            tau, slope = stress(law, x * stretched + own * free)
            step = -float(free @ tau) / float(free @ slope @ free)
            if not abs(step) < FARTHEST:
                return -np.inf, own  # no free strain is near: the path has lost its stability
            own += step
            if abs(step) < SETTLED:
                break
        return margin(law, x * stretched + own * free), own

    if not along(0.0, 0.0)[0] > 0:
        return 1.0
    lost = []
    for end in ends(mode, stretches):
        before, lateral = 0.0, 0.0
        for x in np.linspace(0.0, np.log(end), STEPS + 1)[1:]:
            left, ahead = along(x, lateral)
            if not left > 0:
                for _ in range(HALVINGS):  # past the loss there may be no free strain, and so no margin
                    middle = (before + x) / 2
                    before, x = (middle, x) if along(middle, lateral)[0] > 0 else (before, middle)
                lost.append(x)
                break
            before, lateral = x, ahead
    return float(np.exp(min(lost, key=abs))) if lost else None


def first_loss(law: Law, stretches: tuple[float, float]) -> tuple[str, float] | None:
    """Mode and stretch of the first loss of stability between two principal stretches; None if the law is stable."""
    losses = {mode: loss(law, mode, stretches) for mode in MODES}
    lost = {mode: stretch for mode, stretch in losses.items() if stretch is not None}
    return min(lost.items(), key=lambda one: abs(np.log(one[1])), default=None)
