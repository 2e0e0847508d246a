"""Nominal stresses of incompressible rubber in the three tests, from the energy of any law."""

import numpy as np

from fingerfem.scene.laws import NUMPY, Invariants, Law

# Principal stretches are these powers of the stretch along the pull.
EXPONENTS = {"uniaxial": (1.0, -0.5, -0.5), "equibiaxial": (1.0, 1.0, -2.0), "planar": (1.0, 0.0, -1.0)}
IMAGINARY = 1e-30  # of a derivative, which is exact [-]


def pulled(mode: str) -> int:
    """Directions in which a test pulls."""
    return EXPONENTS[mode].count(1.0)


def principal_stretches(mode: str, stretch: np.ndarray) -> np.ndarray:
    """Principal stretches, shape (points, 3) [-], at stretches along the pull, (points,)."""
    return stretch[:, None] ** np.array(EXPONENTS[mode])


def nominal_stress(law: Law, mode: str, stretch: np.ndarray) -> np.ndarray:
    """Force over the area at rest, shape (points,) [Pa], at stretches along the pull, (points,) [-].

    P = dW/dl / n at J = 1, where n directions are pulled alike.
    """
    squares = principal_stretches(mode, stretch + 1j * IMAGINARY) ** 2
    energy = law.distortional(Invariants(squares.sum(axis=1), (1 / squares).sum(axis=1), 1.0), NUMPY)
    return np.imag(energy) / IMAGINARY / pulled(mode)
