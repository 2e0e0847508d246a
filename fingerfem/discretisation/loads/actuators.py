"""Actuators of a finger: tensions of tendons, then pressures of chambers, as fields that the forms depend on."""

import numpy as np
from dolfinx import fem
from numpy.typing import ArrayLike

from fingerfem.discretisation.mesh import FingerMesh
from fingerfem.scene.scene import Scene


class Actuators:
    """Spreads tensions over the cells that carry them, and pressures over the walls of their chambers.

    A tension is constant in a cell. A pressure is given at the wall's nodes: no two chambers share one.

    Args:
        scene: what is modelled.
        mesh: with its regions.
    """

    def __init__(self, scene: Scene, mesh: FingerMesh):
        by_cell = fem.functionspace(mesh.mesh, ("DG", 0))
        self._cells = [mesh.pulled(scene, k) for k in range(len(scene.tendons))]
        self._load, self._probe = fem.Function(by_cell), fem.Function(by_cell)
        self._pressure: fem.Function | None = None
        self._probe_pressure: fem.Function | None = None
        self._nodes: list[np.ndarray] = []
        if scene.chambers:
            by_node = fem.functionspace(mesh.mesh, ("Lagrange", 1))
            self._pressure, self._probe_pressure = fem.Function(by_node), fem.Function(by_node)
            self._nodes = [fem.locate_dofs_topological(by_node, 2, wall) for wall in mesh.walls]

    @property
    def fields(self) -> dict[str, fem.Function | None]:
        """The functions, as `forms.Fields` names them."""
        return {
            "tension_density": self._load,
            "probe_density": self._probe,
            "pressure": self._pressure,
            "probe_pressure": self._probe_pressure,
        }

    def load(self, values: ArrayLike) -> None:
        """Set the tensions [N], then pressures [Pa], that act, shape (actuators,)."""
        self._spread(np.asarray(values, float), self._load, self._pressure)

    def probe(self, values: ArrayLike) -> None:
        """Set those that energy, lengths, volumes and gradients are asked for."""
        self._spread(np.asarray(values, float), self._probe, self._probe_pressure)

    def _spread(self, values: np.ndarray, density: fem.Function, pressure: fem.Function | None) -> None:
        density.x.array[:] = 0.0
        for tension, (cells, size) in zip(values, self._cells, strict=False):
            density.x.array[cells] += tension / size
        if pressure is not None:
            pressure.x.array[:] = 0.0
            for value, nodes in zip(values[len(self._cells) :], self._nodes, strict=True):
                pressure.x.array[nodes] = value
