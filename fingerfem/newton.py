"""The nonlinear solver: Newton's method on an assembled model: mixed-integration-point, plain, or with line search."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from petsc4py import PETSc

from fingerfem.convergence import NotConverged
from fingerfem.factorisation import Factorisation

if TYPE_CHECKING:
    from fingerfem.model import FingerModel

Strategy = Literal["mixed", "plain", "line search"]


@dataclass(frozen=True, kw_only=True)
class NewtonOptions:
    """When to stop.

    Attributes:
        tolerance: bounds the residual's 2-norm over the force scale E a^2 [-].
        settled: largest displacement of the last iteration, over the length [-], that is as good as the tolerance ...
        noise: ... where the residual is below this and round-off keeps it from falling further.
        iterations: most factorisations in one attempt.
        searches: the same with line search.
        divergence: a residual this many times the first ends an attempt [-]. Steel plates that turn in a large step
            make enormous residuals that the next iterations remove, so it is loose.
    """

    tolerance: float = 1e-10
    settled: float = 1e-10
    noise: float = 1e-8
    iterations: int = 16
    searches: int = 100
    divergence: float = 1e6


class Newton:
    """One linear solver, made once and reused for every step of a model.

    Args:
        model: what is solved; its displacement is the start and the answer.
    """

    def __init__(self, model: FingerModel, options: NewtonOptions | None = None):
        self.model, self.options = model, options or NewtonOptions()
        self.factorisations = 0
        self._factorisation = Factorisation(model.matrix)
        self._update = model.matrix.createVecRight()

    def solve(self, strategy: Strategy = "mixed") -> int:
        """Bring the model's displacement to equilibrium; returns the iterations.

        Args:
            strategy: `mixed` takes the stress at quadrature points for an unknown of its own, `plain` is Newton's
                method with full steps, `line search` shortens them until the potential falls.

        Raises:
            NotConverged: on every rank, with the model's displacement restored.
        """
        model = self.model
        most = self.options.searches if strategy == "line search" else self.options.iterations
        start = model.fields.u.x.array.copy()
        model.fields.previous.x.array[:] = start
        first, moved = None, np.inf
        for iteration in range(most + 1):
            residual = model.residual()
            norm = residual.norm() / model.force_scale
            first = norm if first is None else first
            # Where steel is very stiff against the rubber, round-off keeps the residual up; what Newton's method still
            # moves then tells that there is nothing left to do.
            settled = norm <= self.options.noise and moved <= self.options.settled * model.scene.geometry.length
            if (norm <= self.options.tolerance or settled) and model.smallest_volume_ratio() > 0:
                residual.destroy()
                return iteration
            reason = self._hopeless(norm, first, iteration, most)
            if reason is None:
                reason = self._factorise()
            if reason is None:
                self._factorisation.solve(residual, self._update)
                slope = -model.copies * residual.dot(self._update)
                if not np.isfinite(slope):
                    reason = "the linear solver returned NaN"
                moved = self._update.norm(PETSc.NormType.NORM_INFINITY)  # whole, not what a search leaves of it
            if reason is None and strategy == "line search":
                reason = self._search(slope)
            residual.destroy()
            if reason is not None:
                model.fields.u.x.array[:] = start
                raise NotConverged(reason, iteration)
            if strategy == "mixed":
                model.fields.previous.x.array[:] = model.fields.u.x.array
            self.add(-self._update.array_r)
            if strategy != "mixed":
                model.fields.previous.x.array[:] = model.fields.u.x.array
        raise AssertionError("unreachable")

    def _search(self, slope: float) -> str | None:
        """Shorten the update until the potential falls as its slope [J] promises (Armijo) and no cell turns over."""
        model = self.model
        at = model.fields.u.x.array.copy()
        noise = 1e-12 * model.force_scale * model.scene.geometry.side  # [J]
        if slope > noise:
            return "the tangent is not positive definite: Newton's direction climbs"
        before = model.energy()
        for _ in range(30):
            self.add(-self._update.array_r)
            falls = model.energy() - before <= 1e-4 * slope + noise
            good = falls and model.smallest_volume_ratio() > 0
            model.fields.u.x.array[:] = at
            if good:
                return None
            self._update.scale(0.5)
            slope /= 2
        return "no step along Newton's direction lowers the potential"

    def _hopeless(self, norm: float, first: float, iteration: int, most: int) -> str | None:
        if not np.isfinite(norm):
            return "the residual is not finite"
        if norm <= self.options.tolerance:
            return "a cell is turned inside out"
        if norm > self.options.divergence * max(first, 1e-6):
            return f"diverges: residual {norm:.1e} E a^2 after {iteration} iterations"
        if iteration == most:
            return f"residual still {norm:.1e} E a^2 after {iteration} iterations"
        return None

    def _factorise(self) -> str | None:
        self.model.tangent()
        self.factorisations += 1
        return self._factorisation.update()

    def factorise(self) -> None:
        """Factorise Newton's tangent at the model's displacement, for `linear_solve`.

        Raises:
            NotConverged: the tangent is singular.
        """
        self.model.fields.previous.x.array[:] = self.model.fields.u.x.array
        reason = self._factorise()
        if reason is not None:
            raise NotConverged(reason)

    @property
    def negative_pivots(self) -> int:
        """Negative eigenvalues of the last factorised tangent (Sylvester); an equilibrium with none is stable."""
        return self._factorisation.negative_pivots

    def linear_solve(self, right_hand_side: PETSc.Vec) -> np.ndarray:
        """Solve with the last factorised tangent; returns owned values, and destroys the right-hand side."""
        self._factorisation.solve(right_hand_side, self._update)
        right_hand_side.destroy()
        return self._update.array_r.copy()

    def add(self, owned_values: np.ndarray) -> None:
        """Add owned values to the model's displacement."""
        u = self.model.fields.u.x
        u.array[: len(owned_values)] += owned_values
        u.scatter_forward()
