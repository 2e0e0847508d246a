"""A state seen in every cell and on the surface: stresses, volume ratio, contact pressure; compiled on demand."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import ufl

from fingerfem.discretisation import form_cache, forms, regions
from fingerfem.mechanics import kinematics, strain_energy

if TYPE_CHECKING:
    from fingerfem.model import FingerModel


def cell_fields(model: FingerModel) -> dict[str, np.ndarray]:
    """Fields of the rubber at the cells' midpoints, nan in plates, each of shape (cells,) of this rank.

    S11 is the axial second Piola-Kirchhoff stress [Pa], von_mises that of the Cauchy stress [Pa], both without the
    tendons' own tension; J is the volume ratio [-].
    """
    u, mesh = model.problem.fields.u, model.problem.mesh.mesh
    S = strain_energy.stress(
        strain_energy.energy(model.problem.law, forms.constants(mesh)), kinematics.right_cauchy_green(u)
    )
    F = kinematics.deformation_gradient(u)
    J = ufl.det(F)
    deviator = ufl.dev(F * S * F.T / J)
    sought = {"S11": S[0, 0], "von_mises": ufl.sqrt(1.5 * ufl.inner(deviator, deviator)), "J": J}
    cells = np.arange(len(model.problem.mesh.midpoints.T), dtype=np.int32)
    middle = np.array([[0.5, 0.5, 0.5]])
    compiled = {name: form_cache.expression(value, middle) for name, value in sought.items()}
    found = {name: expression.eval(mesh, cells).ravel() for name, expression in compiled.items()}
    tags = model.problem.mesh.cells
    for values in found.values():
        values[tags.indices[tags.values >= regions.PLATE]] = np.nan
    return found


def contact_pressure(model: FingerModel) -> np.ndarray:
    """Contact pressure at the nodes [Pa], shape (nodes,) of this rank: what a node's share of the surface bears."""
    nodes = len(model.problem.displacement) // 3
    if model.problem.contact is None:
        return np.zeros(nodes)
    v = ufl.TestFunction(model.problem.space)
    ds = forms.surface_measure(model.scene, model.problem.mesh)
    area = model.problem.nodal(form_cache.form(v[1] * ds(regions.SURFACE)))[:, 1]
    force = np.linalg.norm(model.problem.contact.nodal_force(), axis=1)
    return np.divide(force, area, out=np.zeros(nodes), where=area > 0)
