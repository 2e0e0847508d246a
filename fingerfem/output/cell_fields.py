"""A state seen in every cell and on the surface: stresses, volume ratio, contact pressure; compiled on demand."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import ufl

from fingerfem.discretisation import form_cache, forms, regions
from fingerfem.discretisation.tangent import gauss
from fingerfem.discretisation.volume_energies import constants, slopes
from fingerfem.mechanics import kinematics, strain_energy
from fingerfem.scene.laws import Law

if TYPE_CHECKING:
    from fingerfem.model import FingerModel


def cell_fields(model: FingerModel) -> dict[str, np.ndarray]:
    """Fields of the rubber and other materials at the cells' midpoints, nan in plates, shape (cells,) of this rank.

    S11 is the axial second Piola-Kirchhoff stress [Pa], von_mises that of the Cauchy stress [Pa], both without the
    tendons' own tension; J is the volume ratio [-]. In rubber with a pressure of its own, pressure and J are means over
    the points of that pressure: elsewhere the bulk modulus times J - 1 is none.
    """
    fields: dict[str, np.ndarray] = {}
    for k, law in enumerate(model.scene.laws):
        tags = model.problem.mesh.cells
        cells = np.sort(np.concatenate([tags.find(region) for region in regions.of_material(k)]))
        for name, values in _fields_of_material(model, law, cells).items():
            fields.setdefault(name, np.full(len(tags.indices), np.nan))[cells] = values
    return fields


def _fields_of_material(model: FingerModel, law: Law, cells: np.ndarray) -> dict[str, np.ndarray]:
    """The same of the cells of one material, each of shape (cells,)."""
    problem = model.problem
    u, mesh, number = problem.fields.u, problem.mesh.mesh, constants(problem.mesh.mesh)
    whole = strain_energy.energy(law, number), None
    energy, volumetric = strain_energy.parts(law, number) if law.is_mixed else whole
    C, F = kinematics.right_cauchy_green(u), kinematics.deformation_gradient(u)
    S, J = strain_energy.stress(energy, C), ufl.det(F)
    deviator = ufl.dev(F * S * F.T / J)

    def mean(value: Any, points: np.ndarray) -> np.ndarray:
        return form_cache.expression(value, points).eval(mesh, cells).reshape(len(cells), -1).mean(axis=1)

    middle = np.array([[0.5, 0.5, 0.5]])
    sought = {"S11": S[0, 0], "von_mises": ufl.sqrt(1.5 * ufl.inner(deviator, deviator)), "J": J}
    means = {name: mean(value, middle) for name, value in sought.items()}
    if volumetric is not None:
        points, _ = gauss(forms.quadrature_degree(model.scene.mesh.order) - 1)
        pressure, _ = slopes(volumetric, J)
        means["S11"] += mean(pressure, points) * mean(J * ufl.inv(C)[0, 0], middle)
        means["J"] = mean(J, points)
    return means


def contact_pressure(model: FingerModel) -> np.ndarray:
    """Contact pressure at the nodes [Pa], shape (nodes,) of this rank: force over a node's share of the surface."""
    nodes = len(model.problem.displacement) // 3
    if model.problem.contact is None:
        return np.zeros(nodes)
    v = ufl.TestFunction(model.problem.space)
    ds = forms.surface_measure(model.scene, model.problem.mesh)
    area = model.problem.nodal(form_cache.form(v[1] * ds(regions.SURFACE)))[:, 1]
    force = np.linalg.norm(model.problem.contact.nodal_force(), axis=1)
    return np.divide(force, area, out=np.zeros(nodes), where=area > 0)
