"""Mass of the finger by its densities, and its weight, a dead load that is the same in every state."""

from typing import Any

import numpy as np
import ufl
from dolfinx import fem

from fingerfem.discretisation import form_cache, regions
from fingerfem.discretisation.assembly import Assembly
from fingerfem.discretisation.mesh import FingerMesh
from fingerfem.scene.scene import Scene


def inertial_work(mesh: FingerMesh, scene: Scene, degree: int, acceleration: Any, v: Any) -> Any:
    """The integral of density a . v [J], in UFL; of a trial function a it is the consistent mass.

    Args:
        mesh: with its regions.
        scene: with densities.
        degree: of the Gauss rule.
        acceleration: a [m/s^2].
        v: test function [m].
    """
    assert scene.densities is not None
    materials, steel = scene.densities
    dx = ufl.Measure("dx", mesh.mesh, subdomain_data=mesh.cells, metadata={"quadrature_degree": degree})
    parts: list[tuple[float, tuple[int, ...]]] = [(steel, regions.PLATES)]
    parts += [(density, regions.of_material(k)) for k, density in enumerate(materials)]
    return sum(fem.Constant(mesh.mesh, density) * ufl.inner(acceleration, v) * dx(where) for density, where in parts)


def weight_forces(assembly: Assembly, mesh: FingerMesh, scene: Scene, degree: int) -> np.ndarray | None:
    """Nodal forces of weight, shape (owned values,) [N]; None of a scene without gravity (collective).

    Args:
        assembly: of the displacement's space.
        mesh: with its regions.
        scene: with densities and acceleration.
        degree: of the Gauss rule.
    """
    if scene.gravity is None:
        return None
    g, v = fem.Constant(mesh.mesh, scene.gravity.vector), ufl.TestFunction(assembly.space)
    b = assembly.vector(form_cache.form(inertial_work(mesh, scene, degree, g, v)))
    forces = b.array_r.copy()
    b.destroy()
    return forces
