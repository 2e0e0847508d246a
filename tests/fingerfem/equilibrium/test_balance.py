"""Reaction, contact force and the resultants of all cross-sections are in balance, by the stresses themselves."""

from itertools import pairwise

import numpy as np
import pytest
from dolfinx import fem

from fingerfem import FingerModel
from fingerfem.discretisation import form_cache, regions, volume_energies
from fingerfem.discretisation.forms import quadrature_degree
from fingerfem.mechanics import kinematics, strain_energy, tendons
from fingerfem.scene.laws import neo_hookean_from, plate_law
from fingerfem.scene.scene import Scene

INCOMPRESSIBLE = neo_hookean_from(9.88e6, 0.4999)
LAWS = {
    "compressible": None,
    "nearly incompressible": {"law": "neo-hookean", "C1": INCOMPRESSIBLE.C1, "D1": INCOMPRESSIBLE.D1},
}


def resultants(model: FingerModel) -> tuple[np.ndarray, np.ndarray]:
    """Ends of the layers of cells along the axis [m], and the means over each of the section's force [N].

    The force is the integral of P e_x over the section, P the first Piola-Kirchhoff stress of rubber, plates, tendons.
    """
    problem, law = model.problem, model.scene.law
    mesh, degree = problem.mesh, quadrature_degree(model.scene.mesh.order)
    number, u = volume_energies.constants(mesh.mesh), problem.fields.u
    inside = fem.Function(fem.functionspace(mesh.mesh, ("DG", 0)))
    F, C = kinematics.deformation_gradient(u), kinematics.right_cauchy_green(u)
    terms = [
        *volume_energies.rubber_terms([law], number, degree),
        volume_energies.Term(strain_energy.energy(plate_law(law), number), regions.PLATES, degree),
        volume_energies.Term(
            tendons.channelled(problem.fields.tension_density, problem.fields.size), regions.channels(1), degree
        ),
    ]
    forms = [
        form_cache.form(
            inside
            * (F * strain_energy.stress(term.energy, C))[i, 0]
            * volume_energies.volume_measure(mesh, term.degree)((region,))
        )
        for term in terms
        for region in term.regions
        for i in range(3)
    ]
    lines = np.unique(problem.space.tabulate_dof_coordinates()[:, 0].round(9))
    forces = np.zeros((len(lines) - 1, 3))
    for k, (start, end) in enumerate(pairwise(lines)):
        inside.x.array[:] = (mesh.midpoints[0] > start) & (mesh.midpoints[0] < end)
        forces[k] = [sum(map(problem.scalar, forms[i::3])) / (end - start) for i in range(3)]
    return lines[1:], forces


@pytest.mark.parametrize(
    ("name", "taper"),
    [
        ("compressible", 1.0),
        *(
            pytest.param(*one, marks=pytest.mark.long)
            for one in [("nearly incompressible", 1.0), ("compressible", 0.8)]
        ),
    ],
)
def test_every_sections_force_is_what_presses_beyond_it(table, name, taper):
    table["tendons"], table["mesh"]["cells"], table["geometry"]["taper"] = table["tendons"][:1], [12, 5], [taper]
    if LAWS[name] is not None:
        table["material"] = LAWS[name]
    table["mesh"]["symmetry"] = False
    model = FingerModel(Scene.model_validate(table))
    state = model.solve([60.0], 0.010, sensitivities=False)
    problem = model.problem
    ends, forces = resultants(model)
    pressed, x = problem.contact.nodal_force(), problem.space.tabulate_dof_coordinates()[:, 0]
    beyond = np.array([-pressed[x > end - 1e-7].sum(axis=0) for end in ends])
    tolerance = 1e-10 * problem.force_scale * np.sqrt(len(x))
    assert state.contact_force > 1.0
    assert np.abs(forces - beyond).max() < tolerance
    assert np.abs(forces[0] + state.clamp_reaction).max() < tolerance
    assert state.clamp_reaction == pytest.approx([0.0, state.contact_force, 0.0], abs=tolerance)
    free = model.solve([60.0], sensitivities=False)
    assert np.abs(resultants(model)[1]).max() < tolerance
    assert np.abs(free.clamp_reaction).max() < tolerance
