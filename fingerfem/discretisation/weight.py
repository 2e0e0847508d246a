"""The finger's weight: a dead load, the same in every state."""

from __future__ import annotations

import numpy as np
import ufl
from dolfinx import fem

from fingerfem.discretisation import form_cache, regions
from fingerfem.discretisation.assembly import Assembly
from fingerfem.discretisation.mesh import FingerMesh
from fingerfem.scene.tables import Gravity


def weight_forces(assembly: Assembly, mesh: FingerMesh, gravity: Gravity, degree: int) -> np.ndarray:
    """Nodal forces of weight, the integral of density g . v, shape (owned values,) [N] (collective).

    Args:
        assembly: of the displacement's space.
        mesh: with its regions.
        gravity: densities and acceleration.
        degree: of the Gauss rule.
    """
    v, g = ufl.TestFunction(assembly.space), fem.Constant(mesh.mesh, gravity.vector)
    dx = ufl.Measure("dx", mesh.mesh, subdomain_data=mesh.cells, metadata={"quadrature_degree": degree})
    rubber, steel = (fem.Constant(mesh.mesh, value) for value in (gravity.density, gravity.plate_density))
    work = rubber * ufl.inner(g, v) * dx(regions.RUBBERS) + steel * ufl.inner(g, v) * dx(regions.PLATES)
    b = assembly.vector(form_cache.form(work))
    forces = b.array_r.copy()
    b.destroy()
    return forces
