"""The nonlinear solver: Newton's method on an assembled model, mixed-integration-point or plain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from petsc4py import PETSc

from fingerfem.convergence import NotConverged

if TYPE_CHECKING:
    from fingerfem.model import FingerModel


@dataclass(frozen=True, kw_only=True)
class NewtonOptions:
    """When to stop.

    Attributes:
        tolerance: bounds the residual's 2-norm over the force scale E a^2 [-].
        iterations: most factorisations in one attempt.
        divergence: a residual this many times the first ends an attempt [-]. Steel plates that turn in a large step
            make enormous residuals that the next iterations remove, so it is loose.
    """

    tolerance: float = 1e-10
    iterations: int = 14
    divergence: float = 1e6


class Newton:
    """One linear solver, made once and reused for every step of a model.

    Args:
        model: what is solved; its displacement is the start and the answer.
    """

    def __init__(self, model: FingerModel, options: NewtonOptions | None = None):
        self.model, self.options = model, options or NewtonOptions()
        self.factorisations = 0
        ksp = PETSc.KSP().create(model.comm)
        ksp.setType("preonly")
        ksp.setErrorIfNotConverged(False)
        preconditioner = ksp.getPC()
        preconditioner.setType("cholesky")
        preconditioner.setFactorSolverType("mumps")
        ksp.setOperators(model.matrix)
        preconditioner.setFactorSetUpSolverType()
        factor = preconditioner.getFactorMatrix()
        factor.setMumpsIcntl(14, 80)  # room for the fill that pivoting adds [%]
        self._ksp = ksp
        self._update = model.matrix.createVecRight()

    def solve(self, mixed: bool = True) -> int:
        """Bring the model's displacement to equilibrium; returns the iterations.

        Raises:
            NotConverged: on every rank, with the model's displacement restored.
        """
        model, options = self.model, self.options
        start = model.fields.u.x.array.copy()
        model.fields.previous.x.array[:] = start
        first = None
        for iteration in range(options.iterations + 1):
            residual = model.residual()
            norm = residual.norm() / model.force_scale
            first = norm if first is None else first
            if norm <= options.tolerance and model.smallest_volume_ratio() > 0:
                residual.destroy()
                return iteration
            reason = self._hopeless(norm, first, iteration)
            if reason is None:
                reason = self._factorise()
            if reason is None:
                self._ksp.solve(residual, self._update)
                if not np.isfinite(self._update.norm()):
                    reason = "the linear solver returned NaN"
            residual.destroy()
            if reason is not None:
                model.fields.u.x.array[:] = start
                raise NotConverged(reason, iteration)
            if mixed:
                model.fields.previous.x.array[:] = model.fields.u.x.array
            self.add(-self._update.array_r)
            if not mixed:
                model.fields.previous.x.array[:] = model.fields.u.x.array
        raise AssertionError("unreachable")

    def _hopeless(self, norm: float, first: float, iteration: int) -> str | None:
        if not np.isfinite(norm):
            return "the residual is not finite"
        if norm <= self.options.tolerance:
            return "a cell is turned inside out"
        if norm > self.options.divergence * max(first, 1e-6):
            return f"diverges: residual {norm:.1e} E a^2 after {iteration} iterations"
        if iteration == self.options.iterations:
            return f"residual still {norm:.1e} E a^2 after {iteration} iterations"
        return None

    def _factorise(self) -> str | None:
        self.model.tangent()
        self.factorisations += 1
        try:
            self._ksp.setUp()
        except PETSc.Error as error:
            return f"factorisation failed (PETSc error {error.ierr})"
        if self._ksp.getPC().getFailedReason() != PETSc.PC.FailedReason.NOERROR:
            return "factorisation failed"
        return None

    def factorise(self) -> None:
        """Factorise Newton's tangent at the model's displacement, for `linear_solve`.

        Raises:
            NotConverged: the tangent is singular.
        """
        self.model.fields.previous.x.array[:] = self.model.fields.u.x.array
        reason = self._factorise()
        if reason is not None:
            raise NotConverged(reason)

    def linear_solve(self, right_hand_side: PETSc.Vec) -> np.ndarray:
        """Solve with the last factorised tangent; returns owned values, and destroys the right-hand side."""
        self._ksp.solve(right_hand_side, self._update)
        right_hand_side.destroy()
        return self._update.array_r.copy()

    def add(self, owned_values: np.ndarray) -> None:
        """Add owned values to the model's displacement."""
        u = self.model.fields.u.x
        u.array[: len(owned_values)] += owned_values
        u.scatter_forward()
