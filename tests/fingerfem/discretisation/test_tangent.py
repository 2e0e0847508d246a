"""The tangent of one matrix product against the same form, summed cell by cell by FFCx's own kernel."""

import numpy as np
import pytest
import scipy.sparse
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix

from fingerfem import FingerModel
from fingerfem.discretisation import regions, volume_energies
from fingerfem.discretisation.forms import quadrature_degree
from fingerfem.mechanics import kinematics, strain_energy, tendons
from fingerfem.scene.laws import plate_law
from fingerfem.scene.scene import Scene

STIFF = {"law": "neo-hookean", "C1": 1.9e6, "D1": 1e-9}  # nearly incompressible: its pressure is an unknown
SPECIALS = {
    "order 1": {},
    "order 2": {"mesh": {"cells": [7, 5], "order": 2}},
    "mixed, order 2": {"mesh": {"cells": [7, 5], "order": 2}, "material": STIFF},
    "half": {"in_plane": True},
    "straight tendons": {"path": "straight"},
    "tapered": {"mesh": {"cells": [14, 5]}, "taper": [0.7]},
    "tapered, mixed, order 2": {"mesh": {"cells": [10, 5], "order": 2}, "material": STIFF, "taper": [0.7]},
}
QUICK = "order 1", "half"


def changed(table: dict, special: dict) -> dict:
    table = {name: value for name, value in table.items() if name != "sampling"}
    table["mesh"] = {"cells": [10, 5], "order": 1} | special.get("mesh", {})
    if "material" in special:
        table["material"] = special["material"]
    if "path" in special:
        table["tendons"] = [one | {"path": special["path"]} for one in table["tendons"]]
    if "taper" in special:
        table["geometry"] |= {"taper": special["taper"]}
    if "in_plane" in special:
        table["tendons"] = [one | {"offset": [0.004, 0.0]} for one in table["tendons"][:1]]
    return table


def term_by_term(model: FingerModel) -> scipy.sparse.csr_matrix:
    """K = sum of dS(w) : dE(v) + S* : d2E(v, w), S* = S(u0) + dS(u0) du; and what else there is.

    If the pressure is an unknown, K = sum of dp(w) dJ(v) + p* d2J(v, w), p* = p(u0) + dp(u0) du.
    """
    problem, scene = model.problem, model.scene
    u, u0 = problem.fields.u, problem.fields.previous
    v, w, step = ufl.TestFunction(problem.space), ufl.TrialFunction(problem.space), problem.fields.change
    number, degree = volume_energies.constants(problem.mesh.mesh), quadrature_degree(scene.mesh.order)
    terms = [
        *volume_energies.by_region(volume_energies.rubber_terms(scene.laws, number, degree)),
        volume_energies.Term(strain_energy.energy(plate_law(scene.law), number), regions.PLATES, degree),
        volume_energies.Term(
            tendons.channelled(problem.fields.tension_density, problem.fields.size), regions.channels(1), degree
        ),
    ]
    if scene.tendons[0].path == "straight":
        terms.pop()
    C, C0 = kinematics.right_cauchy_green(u), kinematics.right_cauchy_green(u0)
    dE, d2E = kinematics.strain_variation(u, v), ufl.sym(ufl.grad(v).T * ufl.grad(w))
    found = problem.forms.other_tangent
    whole = csr(assemble_matrix(found, bcs=problem.supports, diagonal=0.0))
    for term in terms:
        if term.volumetric is None:
            S, S0 = strain_energy.stress(term.energy, C), strain_energy.stress(term.energy, C0)
            integrand = ufl.inner(ufl.derivative(S, u, w), dE) + ufl.inner(S0 + ufl.derivative(S0, u0, step), d2E)
        else:
            J, J0 = (ufl.variable(ufl.det(ufl.Identity(3) + ufl.grad(field))) for field in (u, u0))
            p, p0 = ufl.diff(term.volumetric(J), J), ufl.diff(term.volumetric(J0), J0)
            dJ = ufl.derivative(J, u, v)
            integrand = ufl.derivative(p, u, w) * dJ + (p0 + ufl.derivative(p0, u0, step)) * ufl.derivative(dJ, u, w)
        form = fem.form(integrand * volume_energies.volume_measure(problem.mesh, term.degree)(term.regions))
        whole = whole + csr(assemble_matrix(form, bcs=problem.supports, diagonal=0.0))
    held = np.zeros(whole.shape[0])
    held[problem.held] = 1.0
    return whole + scipy.sparse.diags(held)


def csr(matrix) -> scipy.sparse.csr_matrix:
    matrix.assemble()
    starts, columns, values = matrix.getValuesCSR()
    return scipy.sparse.csr_matrix((values, columns, starts), shape=matrix.size)


@pytest.mark.parametrize(
    "name",
    [*QUICK, *(pytest.param(one, marks=pytest.mark.long) for one in SPECIALS if one not in QUICK)],
)
def test_it_is_the_form_s_to_round_off(table, name):
    model = FingerModel(Scene.model_validate(changed(table, SPECIALS[name])))
    problem = model.problem
    problem.set_loads([20.0] * len(model.scene.tendons), 0.02)
    x, y, z = problem.space.tabulate_dof_coordinates().T / 0.02
    wave = 2e-4 * np.column_stack([np.sin(x + y), x**2 + z, np.cos(z) * y])
    problem.displacement[:] = 0.9 * wave.ravel()
    problem.extrapolate_stress(0.1 * wave.ravel()[: problem.matrix.getLocalSize()[0]])
    problem.displacement[:] = wave.ravel()
    found, expected = csr(problem.tangent()), term_by_term(model)
    # Row by row: steel is a hundred thousand times as stiff as rubber.
    sizes = abs(expected).max(axis=1).toarray().ravel()
    assert (abs(found - expected).max(axis=1).toarray().ravel() < 1e-12 * sizes).all()
    assert abs(found - found.T).max() < 1e-14 * sizes.max()
