"""Strain energies: a law is nothing but an energy density [J/m^3] as a function of C = F^T F."""

from __future__ import annotations

from dataclasses import dataclass

import ufl


@dataclass(frozen=True, kw_only=True)
class NeoHookean:
    """W = C1 (I1bar - 3) + (J - 1)^2 / D1, with I1bar = J^(-2/3) tr C and J = sqrt(det C).

    Chenevier et al., PLoS ONE 13(2): e0192052 (2018), eq. 4, read so that its units fit.

    C1 [Pa] and D1 [1/Pa] are positive.
    """

    C1: float
    D1: float

    def __post_init__(self) -> None:
        for name in ("C1", "D1"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} must be positive, got {getattr(self, name)}")

    def __call__(self, C):
        """Energy density [J/m^3] at C."""
        J = ufl.sqrt(ufl.det(C))
        return self.C1 * (ufl.det(C) ** (-1 / 3) * ufl.tr(C) - 3) + (J - 1) ** 2 / self.D1

    @property
    def shear_modulus(self) -> float:
        """Mu = 2 C1 [Pa], at small strain."""
        return 2 * self.C1

    @property
    def bulk_modulus(self) -> float:
        """K = 2 / D1 [Pa], at small strain."""
        return 2 / self.D1

    @property
    def young_modulus(self) -> float:
        """E = 9 K mu / (3 K + mu) [Pa], at small strain."""
        mu, K = self.shear_modulus, self.bulk_modulus
        return 9 * K * mu / (3 * K + mu)

    @property
    def poisson(self) -> float:
        """Nu = (3 K - 2 mu) / (6 K + 2 mu) [-], at small strain."""
        mu, K = self.shear_modulus, self.bulk_modulus
        return (3 * K - 2 * mu) / (6 * K + 2 * mu)


def neo_hookean_from(young_modulus: float, poisson: float) -> NeoHookean:
    """The neo-Hookean law with the given small-strain moduli E [Pa] and nu [-]."""
    return NeoHookean(
        C1=young_modulus / (4 * (1 + poisson)),
        D1=6 * (1 - 2 * poisson) / young_modulus,
    )


STEEL = neo_hookean_from(young_modulus=200e9, poisson=0.3)


def stress(energy, C):
    """Second Piola-Kirchhoff stress S = 2 dW/dC [Pa] of an energy density."""
    C = ufl.variable(C)
    return 2 * ufl.diff(energy(C), C)
