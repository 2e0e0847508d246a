"""Strain energies: a law is nothing but an energy density [J/m^3] as a function of C = F^T F."""

from __future__ import annotations

from collections.abc import Callable
from functools import singledispatch
from typing import Any

import ufl

from fingerfem.laws import Law, MooneyRivlin, NeoHookean, SaintVenantKirchhoff

Energy = Callable[[Any], Any]  # C -> W


@singledispatch
def parts(law: Law) -> tuple[Energy, Energy | None]:
    """A law's energy as W(C) + U(J(C)), where U alone grows without bound as the rubber becomes incompressible.

    U is None for a law that has no such part.
    """
    raise NotImplementedError(type(law).__name__)


@parts.register
def _(law: NeoHookean):
    return lambda C: law.C1 * (ufl.det(C) ** (-1 / 3) * ufl.tr(C) - 3), lambda C: _dilatation(C) ** 2 / law.D1


@parts.register
def _(law: MooneyRivlin):
    def distortional(C):
        I2 = (ufl.tr(C) ** 2 - ufl.tr(C * C)) / 2
        first = law.C10 * (ufl.det(C) ** (-1 / 3) * ufl.tr(C) - 3)
        return first + law.C01 * (I2 - 3 - 2 * ufl.ln(ufl.det(C)))

    return distortional, lambda C: _dilatation(C) ** 2 / law.D1


@parts.register
def _(law: SaintVenantKirchhoff):
    mu = law.shear_modulus
    lame = law.bulk_modulus - 2 / 3 * mu

    def energy(C):
        E = (C - ufl.Identity(3)) / 2
        return lame / 2 * ufl.tr(E) ** 2 + mu * ufl.inner(E, E)

    return energy, None


def _dilatation(C):
    return ufl.sqrt(ufl.det(C)) - 1


def energy(law: Law) -> Energy:
    """The whole energy density [J/m^3] as a function of C."""
    distortional, volumetric = parts(law)
    return distortional if volumetric is None else lambda C: distortional(C) + volumetric(C)


def stress(energy: Energy, C):
    """Second Piola-Kirchhoff stress S = 2 dW/dC [Pa] of an energy density."""
    C = ufl.variable(C)
    return 2 * ufl.diff(energy(C), C)
