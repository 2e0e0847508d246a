"""Energy densities [J/m^3] as functions of C = F^T F, with their stress and elasticity.

An isotropic law is a function of the invariants I1, I2, I3 = det C alone. Its derivatives by them are scalars; those of
the invariants are written out:

    dI1/dC = I          dI2/dC = I1 I - C                          dI3/dC = cof C = C^2 - I1 C + I2 I
    d2I2/dC2 [H] = (tr H) I - H        d2I3/dC2 [H] = C H + H C - (tr H) C - I1 H + (I1 tr H - C : H) I

A law's constants enter through `number`: as constants of UFL, whose values are no part of the compiled form, so that
all rubbers of one law share it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import ufl

from fingerfem.scene.laws import NUMPY, Invariants, Law, Maths

Dilatational = Callable[[Any], Any]  # J -> U
Number = Callable[[float], Any]  # replaces a constant in a form


@dataclass(frozen=True)
class Isotropic:
    """An energy by invariants: W of `Invariants`."""

    density: Callable[[Invariants], Any]

    def __call__(self, C: Any) -> Any:
        """W(C) [J/m^3]."""
        I1, I2, I3 = invariants(C)
        return self.density(Invariants(I1, I2, ufl.sqrt(I3)))


Energy = Callable[[Any], Any]  # C -> W; of rubber an `Isotropic`


def invariants(C: Any) -> tuple[Any, Any, Any]:
    """I1, I2 and I3 of C [-]."""
    return ufl.tr(C), (ufl.tr(C) ** 2 - ufl.inner(C, C)) / 2, ufl.det(C)


def parts(law: Law, number: Number = float) -> tuple[Isotropic, Dilatational | None]:
    """A law's energy as W(C) + U(J), where U alone grows without bound as the rubber becomes incompressible.

    U is None for a law that has no such part.
    """
    maths = Maths(number, ufl.ln)
    has_volumetric = law.volumetric(1.0, NUMPY) is not None
    return Isotropic(lambda strain: law.distortional(strain, maths)), (
        (lambda J: law.volumetric(J, maths)) if has_volumetric else None
    )


def of_strain(volumetric: Dilatational) -> Isotropic:
    """U(J) as a function of C."""
    return Isotropic(lambda strain: volumetric(strain.J))


def energy(law: Law, number: Number = float) -> Isotropic:
    """The whole energy density [J/m^3] as a function of C."""
    distortional, volumetric = parts(law, number)
    if volumetric is None:
        return distortional
    return Isotropic(lambda strain: distortional.density(strain) + volumetric(strain.J))


def stress(energy: Energy, C):
    """Second Piola-Kirchhoff stress S = 2 dW/dC [Pa] of an energy density."""
    if not isinstance(energy, Isotropic):
        C = ufl.variable(C)
        return 2 * ufl.diff(energy(C), C)
    slopes, _ = _by_invariants(energy, C)
    return 2 * sum(slope * gradient for slope, gradient in zip(slopes, _gradients(C), strict=True))


def elasticity(energy: Energy, C):
    """Derivative of the stress, dS/dE = 2 dS/dC [Pa], E the Green-Lagrange strain; rank 4, symmetric in each pair."""
    if not isinstance(energy, Isotropic):
        C = ufl.variable(C)
        return 4 * ufl.diff(ufl.diff(energy(ufl.sym(C)), C), C)
    (_, second, third), curvatures = _by_invariants(energy, C)
    first_order, I, I1 = _gradients(C), ufl.Identity(3), ufl.tr(C)  # noqa: E741
    products: Any = 0
    for a, one in enumerate(first_order):
        products = products + ufl.outer(one, sum(curvatures[a][b] * other for b, other in enumerate(first_order)))
    i, j, k, m = ufl.indices(4)

    def symmetric(A: Any, B: Any) -> Any:
        """(A H B + B H A) / 2 of symmetric H, as a tensor of rank 4 with both symmetries."""
        terms = A[i, k] * B[m, j] + A[i, m] * B[k, j] + B[i, k] * A[m, j] + B[i, m] * A[k, j]
        return ufl.as_tensor(terms / 4, (i, j, k, m))

    unit, of_C = symmetric(I, I), symmetric(C, I)
    products = products + second * (ufl.outer(I, I) - unit)
    of_third = 2 * of_C - ufl.outer(C, I) - ufl.outer(I, C) - I1 * unit + I1 * ufl.outer(I, I)
    return 4 * (products + third * of_third)


def _gradients(C: Any) -> tuple[Any, Any, Any]:
    """Gradients of the invariants by C."""
    I, I1, I2, _ = ufl.Identity(3), *invariants(C)  # noqa: E741
    return I, I1 * I - C, C * C - I1 * C + I2 * I


def _by_invariants(energy: Isotropic, C: Any) -> tuple[list[Any], list[list[Any]]]:
    """First and second derivatives of W by I1, I2 and I3 [Pa]."""
    I1, I2, I3 = own = tuple(map(ufl.variable, invariants(C)))
    W = energy.density(Invariants(I1, I2, ufl.sqrt(I3)))
    slopes = [ufl.diff(W, one) for one in own]
    return slopes, [[ufl.diff(slope, one) for one in own] for slope in slopes]
