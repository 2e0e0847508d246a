"""Part `bar`: a bar of the finger's rubber under prescribed motions of its end, by the forms of the full-order model.

comparison.py solves the same bar on the same mesh and compares: `bar.npz` in the study's folder holds mesh and answers.
"""

from __future__ import annotations

import dolfinx
import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI
from scipy.optimize import brentq
from scipy.sparse.linalg import spsolve

from fingerfem import load_scene
from fingerfem.discretisation.forms import quadrature_degree
from fingerfem.discretisation.volume_energies import residual_of
from fingerfem.mechanics import strain_energy
from fingerfem.scene.laws import NeoHookean
from studies.peers.calculix.motions import CELLS, LENGTH, SIDE, STRETCH, Motion, ends, motions
from studies.peers.question import SCENE
from studies.runner import Run

SETTLED = 1e-9  # an update below this [m] is the last: what Newton's method leaves after it is round-off
ITERATIONS = 20  # most of a step


class Bar:
    """The block: its residual and its tangent.

    Attributes:
        u: displacement [m].
        nodes: where they are at rest, shape (nodes, 3) [m].
        cells: their nodes, in the order of `motions.block`, shape (cells, 8).
    """

    def __init__(self, law: NeoHookean):
        corners = [np.zeros(3), np.array([LENGTH, SIDE, SIDE])]
        mesh = dolfinx.mesh.create_box(MPI.COMM_SELF, corners, CELLS, dolfinx.mesh.CellType.hexahedron)
        space = fem.functionspace(mesh, ("Lagrange", 1, (3,)))
        self.u = fem.Function(space)
        volume = ufl.Measure("dx", mesh, metadata={"quadrature_degree": quadrature_degree(1)})
        residual = residual_of([(strain_energy.energy(law), volume)], self.u)
        self._residual = fem.form(residual)
        self._tangent = fem.form(ufl.derivative(residual, self.u))
        self.nodes, self.cells = space.tabulate_dof_coordinates(), space.dofmap.list

    def forces(self) -> np.ndarray:
        """What holds the nodes, shape (nodes, 3) [N]."""
        return fem.assemble_vector(self._residual).array.reshape(-1, 3)

    def follow(self, motion: Motion) -> None:
        """From rest to the end of a motion, by Newton's method.

        Raises:
            AssertionError: a step does not settle.
        """
        self.u.x.array[:] = 0.0
        held = motion.held.ravel()
        free = np.flatnonzero(~held)
        for places in motion.path():
            self.u.x.array[held] = places.ravel()[held]
            for _ in range(ITERATIONS):
                tangent = fem.assemble_matrix(self._tangent).to_scipy().tocsc()[free][:, free]
                update = spsolve(tangent, self.forces().ravel()[free])
                self.u.x.array[free] -= update
                if np.abs(update).max() < SETTLED:
                    break
            else:
                raise AssertionError(
                    f"the bar's Newton iteration must settle, last update {np.abs(update).max():.1e} m"
                )


def stretching_force(law: NeoHookean) -> float:
    """Of the free stretch [N], closed form: P11 = dW/dl1 at the l2 = l3 where dW/dl2 = 0, with J = l1 l2^2.

    W = C1 (J^(-2/3) (l1^2 + 2 l2^2) - 3) + (J - 1)^2 / D1.
    """
    along = 1 + STRETCH

    def slopes(across: float) -> tuple[float, float]:
        J, squares = along * across**2, along**2 + 2 * across**2
        by_J = -2 / 3 * law.C1 * J ** (-5 / 3) * squares + 2 * (J - 1) / law.D1
        even = 2 * law.C1 * J ** (-2 / 3)
        return even * along + by_J * across**2, 2 * even * across + by_J * 2 * along * across

    across = brentq(lambda value: slopes(value)[1], 0.5, 1.0, xtol=1e-15)
    return slopes(across)[0] * SIDE**2


def measure(run: Run) -> dict:
    """Follow all motions, write where they end for comparison.py; how far the free stretch is from its closed form."""
    law = load_scene(SCENE).law
    assert isinstance(law, NeoHookean)
    bar, rows = Bar(law), []
    stored = {"nodes": bar.nodes, "cells": bar.cells}
    _, end = ends(bar.nodes)
    for name, motion in motions(bar.nodes).items():
        bar.follow(motion)
        forces = bar.forces()
        stored |= {f"{name}: displacement": bar.u.x.array.reshape(-1, 3).copy(), f"{name}: forces": forces}
        left = float(np.abs(forces[~motion.held]).max())
        rows.append({"motion": name, "force": forces[end].sum(axis=0).tolist(), "residual": left})
    np.savez(run.folder / "bar.npz", **stored)
    exact = stretching_force(law)
    return {"cells": list(CELLS), "motions": rows, "closed_form": exact, "off": abs(rows[0]["force"][0] / exact - 1)}
