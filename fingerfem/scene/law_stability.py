"""Where a Mooney-Rivlin law loses stability: the stretch at which more strain no longer needs more stress.

Hill's inequality, which commercial codes check as Drucker's stability: every change of the logarithmic strain e does
positive work on the change of the Kirchhoff stress tau that it makes. With the energy as a function of the principal
logarithmic strains, tau_i = dW/de_i, this holds where

    d2W/de_i de_j is positive definite, and (tau_i - tau_j) / (e_i - e_j) > 0 for every pair.

(Hill, J. Mech. Phys. Solids 16, 1968, doi:10.1016/0022-5096(68)90031-8.) For incompressible rubber it is
a_1 + a_2 > 0 and a_1 a_2 + a_2 a_3 + a_3 a_1 > 0, with a_i = C10 lambda_i^2 + C01 / lambda_i^2.
"""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np

# Principal stretches between which a law has to be stable [-]. The draft finger, bent by 100 N on one tendon, has
# 0.72 to 1.15. A state beyond may be past the law's stability; then no equilibrium is found, or it is not stable.
SHORTEST, LONGEST = 0.7, 1.5
# Which principal directions are stretched; the others are free, but for the second one of planar stretch, which keeps
# its length. The ends of each path are where a principal stretch of incompressible rubber is SHORTEST or LONGEST.
MODES = {
    "uniaxial": (np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 1.0]), (SHORTEST, LONGEST)),
    "equibiaxial": (np.array([1.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]), (LONGEST**-0.5, SHORTEST**-0.5)),
    "planar": (np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0]), (SHORTEST, 1 / SHORTEST)),
}
STEPS, ITERATIONS, SETTLED = 40, 50, 1e-14  # along a path; of Newton's method for what is free, and its last step [-]
FARTHEST = 2.0  # largest step of a free logarithmic strain that stays on the path [-]
HALVINGS = 40  # of the step in which stability is lost
EQUAL = 1e-5  # principal strains that differ by less count as equal [-]


class Constants(NamedTuple):
    """Of W = C10 (I1bar - 3) + C01 (I2 - 3 - 4 ln J) + (J - 1)^2 / D1; C10 and C01 [Pa], D1 [1/Pa]."""

    C10: float
    C01: float
    D1: float


def stress(constants: Constants, e: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Principal Kirchhoff stresses at principal logarithmic strains, shape (3,), and their derivatives, (3, 3) [Pa]."""
    C10, C01, D1 = constants
    one, total = np.ones((3, 3)), float(e.sum())
    b, c, J = np.exp(2 * (e - total / 3)), np.exp(2 * (total - e)), np.exp(total)
    I1bar, I2 = b.sum(), c.sum()
    tau = C10 * (2 * b - 2 / 3 * I1bar) + C01 * (2 * (I2 - c) - 4) + 2 * J * (J - 1) / D1
    slope = C10 * (4 * np.diag(b) - 4 / 3 * (b[:, None] + b) + 4 / 9 * I1bar * one)
    slope += C01 * 4 * (I2 * one - c[:, None] - c + np.diag(c))
    return tau, slope + 2 * J * (2 * J - 1) / D1 * one


def margin(constants: Constants, e: np.ndarray) -> float:
    """The least work of a unit strain at principal logarithmic strains [Pa]; above 0 where the law is stable."""
    tau, slope = stress(constants, e)
    shears = [
        (tau[i] - tau[j]) / (e[i] - e[j]) if abs(e[i] - e[j]) > EQUAL else slope[i, i] - slope[i, j]
        for i, j in combinations(range(3), 2)
    ]
    return float(min(np.linalg.eigvalsh(slope)[0], *shears))


def loss(constants: Constants, mode: str) -> float | None:
    """The stretch nearest to 1 at which stability is lost on the path of a mode [-]; None if it is not."""
    stretched, free, ends = MODES[mode]

    def along(x: float, start: float) -> tuple[float, float]:
        """The margin at a strain x, and the strain of what is free, near to `start`."""
        own = start
        for _ in range(ITERATIONS):
            tau, slope = stress(constants, x * stretched + own * free)
            step = -float(free @ tau) / float(free @ slope @ free)
            if not abs(step) < FARTHEST:
                return -np.inf, own  # no free strain is near: the path has lost its stability
            own += step
            if abs(step) < SETTLED:
                break
        return margin(constants, x * stretched + own * free), own

    if not along(0.0, 0.0)[0] > 0:
        return 1.0
    lost = []
    for end in ends:
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


def first_loss(constants: Constants) -> tuple[str, float] | None:
    """Mode and stretch of the first loss of stability between SHORTEST and LONGEST; None if the law is stable."""
    found = {mode: loss(constants, mode) for mode in MODES}
    lost = {mode: stretch for mode, stretch in found.items() if stretch is not None}
    return min(lost.items(), key=lambda one: abs(np.log(one[1])), default=None)
