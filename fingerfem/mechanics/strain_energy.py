"""Strain energies: a law is nothing but an energy density [J/m^3] as a function of C = F^T F.

A law's parameters enter through `number`: as constants of UFL, whose values are no part of the compiled form, so that
all rubbers of one law share it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import singledispatch
from typing import Any

import ufl

from fingerfem.scene.laws import Law, MooneyRivlin, NeoHookean, SaintVenantKirchhoff

Energy = Callable[[Any], Any]  # C -> W
Dilatational = Callable[[Any], Any]  # J -> U
Number = Callable[[float], Any]  # what stands in a form for a parameter


@singledispatch
def parts(law: Law, number: Number = float) -> tuple[Energy, Dilatational | None]:
    """A law's energy as W(C) + U(J), where U alone grows without bound as the rubber becomes incompressible.

    U is None for a law that has no such part.
    """
    raise NotImplementedError(type(law).__name__)


@parts.register
def _(law: NeoHookean, number: Number = float):
    C1, D1 = number(law.C1), number(law.D1)
    return lambda C: C1 * (ufl.det(C) ** (-1 / 3) * ufl.tr(C) - 3), lambda J: (J - 1) ** 2 / D1


@parts.register
def _(law: MooneyRivlin, number: Number = float):
    C10, C01, D1 = number(law.C10), number(law.C01), number(law.D1)

    # C01 (I2 - 3 - 4 ln J) resists a change of volume too, by 16/3 C01 at rest. That part, f(J), belongs to the
    # pressure: with C01 < 0 it would soften what the pressure's few points do not see.
    def distortional(C):
        I2 = (ufl.tr(C) ** 2 - ufl.tr(C * C)) / 2
        first = C10 * (ufl.det(C) ** (-1 / 3) * ufl.tr(C) - 3)
        return first + C01 * (I2 - 3 * ufl.det(C) ** (2 / 3))

    def volumetric(J):
        return (J - 1) ** 2 / D1 + C01 * (3 * J ** (4 / 3) - 3 - 4 * ufl.ln(J))

    return distortional, volumetric


@parts.register
def _(law: SaintVenantKirchhoff, number: Number = float):
    mu, lame = number(law.shear_modulus), number(law.bulk_modulus - 2 / 3 * law.shear_modulus)

    def energy(C):
        E = (C - ufl.Identity(3)) / 2
        return lame / 2 * ufl.tr(E) ** 2 + mu * ufl.inner(E, E)

    return energy, None


def of_strain(volumetric: Dilatational) -> Energy:
    """U(J) as a function of C."""
    return lambda C: volumetric(ufl.sqrt(ufl.det(C)))


def energy(law: Law, number: Number = float) -> Energy:
    """The whole energy density [J/m^3] as a function of C."""
    distortional, volumetric = parts(law, number)
    if volumetric is None:
        return distortional
    dilatational = of_strain(volumetric)
    return lambda C: distortional(C) + dilatational(C)


def stress(energy: Energy, C):
    """Second Piola-Kirchhoff stress S = 2 dW/dC [Pa] of an energy density."""
    C = ufl.variable(C)
    return 2 * ufl.diff(energy(C), C)


def elasticity(energy: Energy, C):
    """Its derivative dS/dE = 2 dS/dC [Pa], E the Green-Lagrange strain; rank 4, symmetric in each pair."""
    C = ufl.variable(C)
    return 4 * ufl.diff(ufl.diff(energy(ufl.sym(C)), C), C)
