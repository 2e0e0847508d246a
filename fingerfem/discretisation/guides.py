"""Tendons with their own tension in every layer of the mesh: lengths, turns and nodal forces."""

import numpy as np
import ufl
from dolfinx import fem
from petsc4py import PETSc

from fingerfem.discretisation import form_cache, regions
from fingerfem.discretisation.forms import quadrature_degree
from fingerfem.discretisation.problem import Problem
from fingerfem.discretisation.volume_energies import volume_measure


class GuideLayers:
    """The layers of a problem's channels between the grid's planes, from the clamp to each tendon's plate.

    Args:
        problem: the discrete problem, on one rank.

    Attributes:
        cells: of tendon k in its layers, lists of shapes (cells,).
        middles: of these layers, along the axis at rest, shape (n,) [m].
    """

    def __init__(self, problem: Problem):
        self._problem, mesh, scene = problem, problem.mesh, problem.scene
        x, u = ufl.SpatialCoordinate(mesh.mesh), problem.fields.u
        size, along = problem.fields.size, ufl.as_vector((1.0, 0.0, 0.0))
        if size is not None:
            along = ufl.as_vector((1.0, x[1] * size.dx(0) / size, x[2] * size.dx(0) / size))
        path = along + ufl.grad(u) * along
        section = 1.0 if size is None else size**2
        by_cell = fem.functionspace(mesh.mesh, ("DG", 0))
        test = ufl.TestFunction(by_cell)
        kinds = regions.channels(len(scene.laws))
        channels = volume_measure(mesh, quadrature_degree(scene.mesh.order))(kinds)
        stretch = ufl.sqrt(ufl.dot(path, path))
        wanted = [test * one / section * channels for one in (stretch, path[0], path[1], path[2])]
        self._lengths, *self._paths = form_cache.forms(wanted)
        layers = np.searchsorted(mesh.lines, mesh.midpoints[0]) - 1
        in_channels = np.concatenate([mesh.cells.find(kind) for kind in kinds])
        self.cells: list[list[np.ndarray]] = []
        self.middles: list[np.ndarray] = []
        self._areas: list[float] = []
        for k in range(len(scene.tendons)):
            cells, area = mesh.pulled(scene, k)
            inside = np.intersect1d(np.flatnonzero(cells), in_channels)
            used = np.unique(layers[inside])
            self.cells.append([inside[layers[inside] == layer] for layer in used])
            self.middles.append((mesh.lines[used] + mesh.lines[used + 1]) / 2)
            self._areas.append(area)

    def load(self, tensions: list[np.ndarray]) -> None:
        """Set the tensions that act in the layers, of every tendon shape (n,) [N]."""
        density = self._problem.fields.tension_density.x.array
        density[:] = 0.0
        for own, cells, area in zip(tensions, self.cells, self._areas, strict=True):
            for tension, layer in zip(own, cells, strict=True):
                density[layer] += tension / area

    def lengths(self) -> list[np.ndarray]:
        """Lengths of the channels in all layers, of every tendon, shape (n,) [m]."""
        by_cell = fem.assemble_vector(self._lengths).array
        return [
            self._problem.copies * np.array([by_cell[layer].sum() for layer in cells]) / area
            for cells, area in zip(self.cells, self._areas, strict=True)
        ]

    def turns(self) -> list[np.ndarray]:
        """Angles between each layer's mean direction and that of the layer before, or the axis at the clamp [rad]."""
        by_cell = np.stack([fem.assemble_vector(form).array for form in self._paths], axis=-1)
        angles = []
        for cells in self.cells:
            ways = np.array([[1.0, 0.0, 0.0], *(by_cell[layer].sum(axis=0) for layer in cells)])
            ways /= np.linalg.norm(ways, axis=1)[:, None]
            sines = np.linalg.norm(np.cross(ways[1:], ways[:-1]), axis=1)
            angles.append(np.arctan2(sines, np.sum(ways[1:] * ways[:-1], axis=1)))
        return angles

    def gradients(self) -> list[PETSc.Vec]:
        """Gradients of all layers' lengths by the displacement, tendon by tendon [-]; the caller destroys them."""
        problem = self._problem
        density, gradients = problem.fields.probe_density.x.array, []
        for cells, area in zip(self.cells, self._areas, strict=True):
            for layer in cells:
                density[:] = 0.0
                density[layer] = 1.0 / area
                gradients.append(problem.gradient(problem.forms.actuator_force))
        return gradients
