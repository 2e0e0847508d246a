"""The energies of the volume: rubber, plates, tendons in channels; their residual and the moduli of their tangent.

Every one but that of straight tendons is a density W(C):

    residual   R(u; v)    = sum of  S : dE(v)                        S = 2 dW/dC
    tangent    K(u; v, w) = sum of  dS(w) : dE(v) + S* : d2E(v, w)
                          = sum of  A[i J, k L] dv_i/dX_J dw_k/dX_L

with the moduli A[i J, k L] = F[i M] dS/dE[M J, N L] F[k N] + delta[i k] S*[J L], which `tangent` makes it from. With
S* = S(u) this is Newton's tangent. The mixed-integration-point form (Magisano, Leonetti, Garcea, Int. J. Numer.
Meth. Eng. 109, 2017, doi:10.1002/nme.5228) takes the stress for an unknown of its own at every quadrature point and
eliminates it there, which leaves S* = S(u0) + dS(u0) du, the stress that the last iterate u0 predicted for the change
du. Both are one form here: with u0 = u and du = 0 it is Newton's.

Nearly incompressible rubber, W(C) + U(J), has a pressure p = U'(J) for an unknown of its own, discontinuous from cell
to cell and given by its values at the points of a reduced Gauss rule, one point for order 1 and eight for order 2. The
constraint on p couples no two points, so p is eliminated where it stands, which leaves U integrated by that rule:
Malkus, Hughes, Comput. Methods Appl. Mech. Eng. 15, 1978, doi:10.1016/0045-7825(78)90005-1. Its moduli are those of
Newton's method for u and p,

    A[i J, k L] = U''(J) H[i J] H[k L] + p* d2J/dF[i J]dF[k L]     H = dJ/dF     p* = U'(J0) + U''(J0) H0 : grad du.

A tangent step keeps J to first order only. U'(J) is then the bulk modulus times a second-order error, p* is not: the
iterations do not grow with the bulk modulus.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import ufl
from dolfinx import fem

from fingerfem.discretisation import regions
from fingerfem.discretisation.mesh import FingerMesh
from fingerfem.discretisation.tangent import PAIRS
from fingerfem.mechanics import kinematics, strain_energy
from fingerfem.scene.laws import Law


class Term(NamedTuple):
    """An energy density of C, where it is, and the degree of the Gauss rule it is integrated by.

    `volumetric` is the same energy as a function of J, if its pressure is an unknown.
    """

    energy: strain_energy.Energy
    regions: tuple[int, ...]
    degree: int
    volumetric: strain_energy.Dilatational | None = None


class Overstress(NamedTuple):
    """Stress that viscoelastic branches add to that of rubber in a step: share S(C) + stress, S of a law's W.

    That is the stress of an energy too, share W(C) + stress : C / 2, so that a step has a potential.
    """

    shares: list[fem.Constant]  # by material [-]
    stress: fem.Function  # second Piola-Kirchhoff stress at the points of integration [Pa]


def volume_measure(mesh: FingerMesh, degree: int) -> ufl.Measure:
    """The volume, integrated by a Gauss rule of that degree."""
    return ufl.Measure("dx", mesh.mesh, subdomain_data=mesh.cells, metadata={"quadrature_degree": degree})


def constants(domain: Any) -> strain_energy.Number:
    """Numbers as constants of a mesh or its domain: what is compiled is then the same for all their values."""
    return lambda value: fem.Constant(domain, value)


def rubber_terms(
    laws: Sequence[Law], number: strain_energy.Number, degree: int, overstress: Overstress | None = None
) -> list[Term]:
    """The energies of the rubber and of other materials, split where a pressure is an unknown of its own.

    With what viscoelastic branches add to them, if there are any.
    """
    terms = []
    for k, law in enumerate(laws):
        where = regions.of_material(k)
        relaxes = overstress is not None and law.prony is not None
        if not law.is_mixed and not relaxes:
            terms.append(Term(strain_energy.energy(law, number), where, degree))
            continue
        distortional, volumetric = strain_energy.parts(law, number)
        assert volumetric is not None  # a law without one has no branches, and stays below where mixed begins
        dilatational = strain_energy.of_strain(volumetric)
        if overstress is not None and relaxes:
            distortional = _stiffened(distortional, overstress.shares[k])
            terms.append(Term(lambda C: ufl.inner(overstress.stress, C) / 2, where, degree))
        terms.append(Term(distortional, where, degree))
        terms.append(
            Term(dilatational, where, degree - 1, volumetric) if law.is_mixed else Term(dilatational, where, degree)
        )
    return terms


def _stiffened(energy: strain_energy.Isotropic, share: fem.Constant) -> strain_energy.Isotropic:
    """The same energy and a share of it more."""
    return strain_energy.Isotropic(lambda strain: (1 + share) * energy.density(strain))


def by_region(terms: Sequence[Term]) -> list[Term]:
    """The same terms, such that DOLFINx 0.9 integrates terms of two degrees over one region.

    It assembles the first of two integrals over a region twice and drops the second. UFL makes them two where it sees
    the same integrand in other regions too; written differently, it does not.
    """
    if len({term.degree for term in terms}) == 1:
        return list(terms)
    return [
        term._replace(energy=_written(term.energy, k), regions=(region,))
        for term in terms
        for k, region in enumerate(term.regions)
    ]


def _written(energy: strain_energy.Energy, k: int) -> strain_energy.Energy:
    """The same energy, in a way of writing it that depends on k; no `Isotropic`, of which scalars stay the same."""
    return lambda C: 2.0**k * (0.5**k * energy(C))


def residual_of(terms: Sequence[tuple[strain_energy.Energy, Any]], u: fem.Function) -> Any:
    """Residual of energies W(C), each with its measure."""
    v, C = ufl.TestFunction(u.function_space), kinematics.right_cauchy_green(u)
    dE = kinematics.strain_variation(u, v)
    return sum(ufl.inner(strain_energy.stress(energy, C), dE) * where for energy, where in terms)


def moduli_of(term: Term, u: fem.Function, u0: fem.Function, change: fem.Function) -> Any:
    """A[i J, k L] at u, with the stress that u0 predicts [Pa], by `tangent.PAIRS` (i, k), then J, then L."""
    of_gradient = _moduli_by_strain if term.volumetric is None else _moduli_by_volume
    moduli = of_gradient(term, u, u0, change)
    axes = [(a, b) for a in range(3) for b in range(3)]
    return ufl.as_vector([moduli(one, other)[a, b] for one, other in PAIRS for a, b in axes])


def _moduli_by_strain(term: Term, u: fem.Function, u0: fem.Function, change: fem.Function) -> Callable[[int, int], Any]:
    """Moduli of W(C): by i and k the matrix of J and L."""
    energy = term.energy
    C0, dE = kinematics.right_cauchy_green(u0), kinematics.strain_variation(u0, change)
    i, k, J, L, M, N = ufl.indices(6)
    further = ufl.as_tensor(strain_energy.elasticity(energy, C0)[J, L, M, N] * dE[M, N], (J, L))
    predicted = strain_energy.stress(energy, C0) + further
    F, elasticity = (
        kinematics.deformation_gradient(u),
        strain_energy.elasticity(energy, kinematics.right_cauchy_green(u)),
    )
    material = ufl.as_tensor(F[i, M] * elasticity[M, J, N, L] * F[k, N], (i, J, k, L))
    zero = ufl.zero(3, 3)
    return lambda one, other: material[one, :, other, :] + (predicted if one == other else zero)


def _moduli_by_volume(term: Term, u: fem.Function, u0: fem.Function, change: fem.Function) -> Callable[[int, int], Any]:
    """Moduli of U(J): by i and k the matrix of J and L."""
    assert term.volumetric is not None
    F, F0 = kinematics.deformation_gradient(u), kinematics.deformation_gradient(u0)
    H, H0 = kinematics.cofactor(F), kinematics.cofactor(F0)
    _, stiffness = slopes(term.volumetric, ufl.det(F))
    pressure, slope = slopes(term.volumetric, ufl.det(F0))
    predicted = pressure + slope * ufl.inner(H0, ufl.grad(change))

    def moduli(one: int, other: int) -> Any:
        material = stiffness * ufl.outer(H[one, :], H[other, :])
        if one == other:
            return material
        third = F[3 - one - other, :] * (-1) ** (other - one + 1)  # for one < other: eps[one, other, third]
        return material + predicted * kinematics.axial(third)

    return moduli


def slopes(volumetric: strain_energy.Dilatational, J: Any) -> tuple[Any, Any]:
    """Pressure U'(J) and its derivative U''(J) [Pa]."""
    J = ufl.variable(J)
    pressure = ufl.diff(volumetric(J), J)
    return pressure, ufl.diff(pressure, J)


def total(terms: Sequence[tuple[strain_energy.Energy, Any]], u: fem.Function) -> Any:
    """The energy itself [J]."""
    C = kinematics.right_cauchy_green(u)
    return sum(energy(C) * where for energy, where in terms)
