"""Natural modes of a finger about an equilibrium: K f = w^2 M f, with the tangent K and the consistent mass M.

Shift-invert Lanczos about zero (ARPACK through SciPy) with the factors that Newton's method makes: the modes nearest to
zero, those of negative w^2, an equilibrium that is not stable, among them.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from petsc4py import PETSc
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

from fingerfem.dynamics.moving_problem import MovingProblem
from fingerfem.equilibrium.continuation import Continuation
from fingerfem.equilibrium.failures import NotConverged
from fingerfem.scene.scene import Scene

SEED = 0  # of the vector that the iteration begins with


@dataclass(frozen=True, kw_only=True)
class Modes:
    """Modes, by growing |w^2|.

    Attributes:
        frequencies: w / 2 pi, shape (modes,) [Hz]; negative ones grow, at the rate 2 pi |frequency|.
        participation: effective mass along x, y and z over the finger's, shape (modes, 3) [-].
        residuals: |K f - w^2 M f| over |K f| of every mode, shape (modes,) [-].
        shapes: displacements of the nodes, shape (modes, 3 nodes) [kg^-1/2], of unit modal mass.
        lines: x [m] of every cross-section of nodes, and the mean displacement there, shape (modes, sections, 4).
        mass: of the finger [kg].
    """

    frequencies: np.ndarray
    participation: np.ndarray
    residuals: np.ndarray
    shapes: np.ndarray = field(repr=False)
    lines: np.ndarray = field(repr=False)
    mass: float

    @property
    def titles(self) -> list[str]:
        """A line about every mode."""
        return [
            f"{frequency:.4g} Hz, mass along x, y, z {', '.join(f'{share:.0%}' for share in shares)}"
            for frequency, shares in zip(self.frequencies, self.participation, strict=True)
        ]

    def as_json(self) -> dict[str, Any]:
        """Plain numbers, without shapes."""
        listed = "frequencies", "participation", "residuals"
        return {name: getattr(self, name).tolist() for name in listed} | {
            "mass": self.mass,
            "stable": bool((self.frequencies > 0).all()),
        }


class ModalAnalysis:
    """Modes of a scene's whole finger.

    Args:
        scene: with densities.

    Raises:
        ValueError: the scene has no densities, or contact by Nitsche's method.

    Example:
        >>> ModalAnalysis(load_scene("scenes/moving.toml")).solve([5.0, 0.0], count=4).frequencies
    """

    def __init__(self, scene: Scene):
        whole = scene.mesh.model_copy(update={"symmetry": False})
        self.problem = MovingProblem(scene.model_copy(update={"mesh": whole}))
        self._continuation = Continuation(self.problem)

    def solve(
        self, tensions: ArrayLike, distance: float | None = None, count: int = 6, *, instantaneous: bool = False
    ) -> Modes:
        """The modes about the equilibrium at these loads.

        Args:
            tensions: of tendons [N], then pressures [Pa], shape (actuators,).
            distance: of the obstacle [m]; None leaves it away.
            count: of modes.
            instantaneous: viscoelastic branches have their instantaneous stiffness; by default they are relaxed.

        Raises:
            LoadNotReached: there is no equilibrium.
            NotConverged: its tangent is singular, or the modes do not converge.
        """
        problem, continuation = self.problem, self._continuation
        continuation.rest()
        continuation.advance(tensions, None)
        if distance is not None:
            continuation.advance(tensions, distance)
        if problem.branches is not None:
            problem.branches.begin(0.0) if instantaneous else problem.branches.stay()
        linearisation = continuation.linearise()
        mass = _csr(problem.mass)
        unknowns = mass.shape[0]
        free = np.setdiff1d(np.arange(unknowns), problem.held)
        if not 0 < count < len(free) // 2:
            raise ValueError(f"count must be above 0 and below {len(free) // 2}, got {count}")

        def inverse(values: np.ndarray) -> np.ndarray:
            given = problem.matrix.createVecRight()
            given.array[:] = values
            given.array[problem.held] = 0.0
            return linearisation.solve(given)

        stiffness = _csr(problem.matrix)
        inverted = LinearOperator((unknowns, unknowns), matvec=inverse, dtype=float)
        start = np.random.default_rng(SEED).normal(size=unknowns)
        start[problem.held] = 0.0
        try:
            squares, shapes = eigsh(stiffness, count, mass, sigma=0.0, OPinv=inverted, v0=start)
        except ArpackNoConvergence as failure:
            raise NotConverged(f"{len(failure.eigenvalues)} of {count} modes converged") from None
        finally:
            if problem.branches is not None:
                problem.branches.stay()
        order = np.argsort(np.abs(squares))
        return self._modes(squares[order], shapes.T[order], stiffness, mass)

    def _modes(self, squares: np.ndarray, shapes: np.ndarray, stiffness: csr_matrix, mass: csr_matrix) -> Modes:
        """The report of eigenvalues [1/s^2] and their vectors."""
        problem = self.problem
        shapes = shapes / np.sqrt(np.einsum("kn,kn->k", shapes, (mass @ shapes.T).T))[:, None]
        forces = (stiffness @ shapes.T).T
        left = np.linalg.norm(forces - squares[:, None] * (mass @ shapes.T).T, axis=1)
        directions = np.tile(np.eye(3), len(problem.rest))
        loaded = np.array([problem.times_mass(one, whole=True) for one in directions])
        whole = float(directions[0] @ loaded[0])
        sections, inverse = np.unique(np.round(problem.rest[:, 0], 9), return_inverse=True)
        counts = np.bincount(inverse)
        nodal = shapes.reshape(len(shapes), -1, 3)
        means = np.array([[np.bincount(inverse, own) / counts for own in one.T] for one in nodal])
        along = np.broadcast_to(sections, (len(shapes), 1, len(sections)))
        return Modes(
            frequencies=np.sign(squares) * np.sqrt(np.abs(squares)) / (2 * np.pi),
            participation=(shapes @ loaded.T) ** 2 / whole,
            residuals=left / np.linalg.norm(forces, axis=1),
            shapes=shapes,
            lines=np.concatenate([along, means], axis=1).transpose(0, 2, 1),
            mass=whole,
        )


def _csr(matrix: PETSc.Mat) -> csr_matrix:
    starts, columns, values = matrix.getValuesCSR()
    return csr_matrix((values, columns, starts), shape=matrix.getSize())
