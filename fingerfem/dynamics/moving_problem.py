"""The discrete problem of a finger in motion: that of its equilibria, and inertia.

Displacements are seen from the base, which has the acceleration a, the angular velocity w and the orientation R.
Material at x that moves with the velocity v has, per mass, the force

    R^T g - a - w' x x - w x (w x x) - 2 w x v

in place of g. With a consistent mass matrix M that is M times the force at the nodes: positions and velocities are in
the space of the displacement. Mass acts on displacements alone, also where rubber has a pressure of its own.
"""

from typing import NamedTuple

import numpy as np
import ufl
from dolfinx.fem.petsc import assemble_matrix
from mpi4py import MPI
from petsc4py import PETSc

from fingerfem.discretisation import form_cache
from fingerfem.discretisation.branches import Branches
from fingerfem.discretisation.forms import quadrature_degree
from fingerfem.discretisation.loads.weight import inertial_work
from fingerfem.discretisation.problem import Problem
from fingerfem.discretisation.volume_energies import volume_measure
from fingerfem.equilibrium.factorisation import Factorisation
from fingerfem.mechanics import kinematics
from fingerfem.scene.scene import Scene
from rom.dataset.rigid_motion import BaseMotion


class Base(NamedTuple):
    """The base at one time: how it moves, and its orientation R, shape (3, 3)."""

    motion: BaseMotion
    rotation: np.ndarray


class Inertia(NamedTuple):
    """Terms added to the residual of an equilibrium: mass M u + forces; and the velocity v = rate u + remainder.

    Attributes:
        mass: [1/s^2].
        forces: at the nodes, shape (owned values,) [N].
        rate: [1/s].
        remainder: shape (owned values,) [m/s].
    """

    mass: float
    forces: np.ndarray
    rate: float
    remainder: np.ndarray


class MovingProblem(Problem):
    """A finger with mass. Without `inertia` and `base` it is that of the equilibria.

    Attributes:
        mass: M without rows and columns that supports hold [kg].
        branches: of viscoelastic rubber, if it is.

    Args:
        scene: with densities.

    Raises:
        ValueError: the scene has no densities, or contact by Nitsche's method.
    """

    def __init__(self, scene: Scene):
        if scene.densities is None:
            raise ValueError("density must be given for motion, as a table [density] with rubber, got none")
        if scene.obstacle is not None and scene.obstacle.method != "penalty":
            raise ValueError(f"obstacle.method must be penalty for motion, got {scene.obstacle.method}")
        super().__init__(scene, MPI.COMM_SELF)
        degree = quadrature_degree(scene.mesh.order)
        trial, v = ufl.TrialFunction(self.space), ufl.TestFunction(self.space)
        form = form_cache.form(inertial_work(self.mesh, scene, degree, trial, v))
        self._whole = assemble_matrix(form)
        self.mass = assemble_matrix(form, bcs=self.supports, diagonal=0.0)
        for matrix in (self._whole, self.mass):
            matrix.assemble()
        self.rest = self.space.tabulate_dof_coordinates()
        self.inertia: Inertia | None = None
        self.base: Base | None = None
        self.branches: Branches | None = None
        if self.fields.overstress is not None:
            self.branches = Branches(scene.laws, self.mesh, self.fields.u, self.fields.overstress, degree)
            dE, dx = kinematics.strain_variation(self.fields.u, v), volume_measure(self.mesh, degree)
            self._of_branches = form_cache.form(ufl.inner(self.fields.overstress.stress, dE) * dx)

    def times_mass(self, values: np.ndarray, *, whole: bool = False) -> np.ndarray:
        """M values, shape (owned values,); of the whole mass, the rows that supports hold too."""
        return product(self._whole if whole else self.mass, values)

    def body_forces(self, velocity: np.ndarray) -> np.ndarray:
        """Forces of weight and of the base's motion at the current displacement, shape (owned values,) [N]."""
        weight = np.zeros_like(velocity) if self._weight is None else self._weight
        return weight if self.base is None else weight + self._base_forces(velocity)

    def branch_forces(self) -> np.ndarray:
        """Forces of the current overstresses, shape (owned values,) [N]."""
        if self.branches is None:
            return np.zeros(3 * self.space.dofmap.index_map.size_local)
        b = self.gradient(self._of_branches)
        forces = b.array_r.copy()
        b.destroy()
        return forces

    def _base_forces(self, velocity: np.ndarray) -> np.ndarray:
        """The part of the base's motion."""
        assert self.base is not None
        (acceleration, spin, rate), rotation = self.base
        g = np.zeros(3) if self.scene.gravity is None else self.scene.gravity.vector
        x, v = self.rest + self.displacement.reshape(-1, 3), velocity.reshape(-1, 3)
        force = rotation.T @ g - g - acceleration - np.cross(rate, x)
        force = force - np.cross(spin, np.cross(spin, x)) - 2 * np.cross(spin, v)
        return self.times_mass(force.ravel(), whole=True)

    def residual(self) -> tuple[PETSc.Vec, np.ndarray]:
        """Residual of an equilibrium plus inertia; the reaction is the equilibrium's part."""
        b, reaction = super().residual()
        u = self.displacement
        if self.base is not None:
            velocity = np.zeros_like(u) if self.inertia is None else self.inertia.rate * u + self.inertia.remainder
            b.array[:] -= self._base_forces(velocity)
        if self.inertia is not None:
            b.array[:] += self.inertia.mass * self.times_mass(u) + self.inertia.forces
        b.array[self.held] = 0.0
        return b, reaction

    def tangent(self) -> PETSc.Mat:
        """Tangent with the mass's part. That of spin is left out, a share w h of it, which costs iterations alone."""
        matrix = super().tangent()
        if self.inertia is not None:
            matrix.axpy(self.inertia.mass, self.mass, PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)
        return matrix


def product(matrix: PETSc.Mat, values: np.ndarray) -> np.ndarray:
    """Matrix times owned values, shape (owned values,)."""
    given, found = matrix.createVecRight(), matrix.createVecLeft()
    given.array[:] = values
    matrix.mult(given, found)
    result = found.array_r.copy()
    given.destroy()
    found.destroy()
    return result


def solution(factorisation: Factorisation, values: np.ndarray, held: np.ndarray) -> np.ndarray:
    """The inverse of a matrix times owned values that are zero where held, shape (owned values,)."""
    given, found = factorisation.matrix.createVecLeft(), factorisation.matrix.createVecRight()
    given.array[:] = values
    given.array[held] = 0.0
    factorisation.solve(given, found)
    result = found.array_r.copy()
    given.destroy()
    found.destroy()
    return result
