"""The finger's weight: a dead load, the same in every state."""

from __future__ import annotations

import numpy as np
import ufl
from dolfinx import fem

from fingerfem.discretisation import form_cache, regions
from fingerfem.discretisation.assembly import Assembly
from fingerfem.discretisation.mesh import FingerMesh
from fingerfem.scene.scene import Scene


def weight_forces(assembly: Assembly, mesh: FingerMesh, scene: Scene, degree: int) -> np.ndarray | None:
    """Nodal forces of weight, the integral of density g . v, shape (owned values,) [N]; None without (collective).

    Args:
        assembly: of the displacement's space.
        mesh: with its regions.
        scene: with densities and acceleration.
        degree: of the Gauss rule.
    """
    gravity = scene.gravity
    if gravity is None:
        return None
    v, g = ufl.TestFunction(assembly.space), fem.Constant(mesh.mesh, gravity.vector)
    dx = ufl.Measure("dx", mesh.mesh, subdomain_data=mesh.cells, metadata={"quadrature_degree": degree})
    densities = [gravity.density, *(one.density or gravity.density for one in scene.materials)]
    parts: list[tuple[float, tuple[int, ...]]] = [(gravity.plate_density, regions.PLATES)]
    parts += [(density, regions.of_material(k)) for k, density in enumerate(densities)]
    work = sum(fem.Constant(mesh.mesh, density) * ufl.inner(g, v) * dx(where) for density, where in parts)
    b = assembly.vector(form_cache.form(work))
    forces = b.array_r.copy()
    b.destroy()
    return forces
