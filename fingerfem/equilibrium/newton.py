"""The nonlinear solver: Newton's method on a discrete problem: mixed-integration-point, plain, or with line search."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from petsc4py import PETSc

from fingerfem.discretisation.problem import Problem
from fingerfem.equilibrium.factorisation import Factorisation
from fingerfem.equilibrium.failures import BeyondLaw, NotConverged
from fingerfem.equilibrium.linearisation import Linearisation
from fingerfem.equilibrium.stability import AntisymmetricMotion

Strategy = Literal["mixed", "plain", "line search"]
ROUND_OFF = 5.0  # times the estimate of a residual's round-off, which is within a factor of two [-]


@dataclass(frozen=True, kw_only=True)
class NewtonOptions:
    """Stopping criteria of Newton's method.

    Attributes:
        tolerance: bounds the residual's 2-norm over the force scale E A [-].
        settled: largest displacement of the last iteration, over the length [-], that is as good as the tolerance ...
        noise: ... where the residual is below this [-], or below ROUND_OFF of what `Newton.round_off` estimates.
        iterations: most factorisations in one attempt.
        near: residual below which the last factors serve on ...
        contraction: ... as long as a step with them leaves no more than this of the residual [-]. Such a step takes a
            tenth of the time of one with new factors.
        searches: the same with line search.
        divergence: a residual this many times the first ends an attempt [-]. Steel plates that turn in a large step
            make enormous residuals that the next iterations remove, so it is loose.
    """

    tolerance: float = 1e-10
    settled: float = 1e-10
    noise: float = 1e-8
    iterations: int = 16
    near: float = 1e-2
    contraction: float = 0.3
    searches: int = 100
    divergence: float = 1e6


class Newton:
    """One linear solver, made once and reused for every step.

    Args:
        problem: what is solved; its displacement is the start and the answer.
        options: when to stop.
    """

    def __init__(self, problem: Problem, options: NewtonOptions | None = None):
        self.problem, self.options = problem, options or NewtonOptions()
        self._factorisation = Factorisation(problem.matrix)
        self._antisymmetric = AntisymmetricMotion(problem)
        self._update, self._rounded = problem.matrix.createVecRight(), problem.matrix.createVecRight()

    @property
    def factorisations(self) -> int:
        """Number of tangents factorised."""
        return self._factorisation.made

    def solve(self, strategy: Strategy = "mixed", *, is_predicted: bool = False) -> tuple[int, Linearisation | None]:
        """Bring the problem's displacement to equilibrium.

        Returns the factorisations and the last tangent, not quite at the answer; None if there was none.

        Args:
            strategy: `mixed` takes the stress at quadrature points for an unknown of its own, `plain` is Newton's
                method with full steps, `line search` shortens them until the potential falls.
            is_predicted: the stress was extrapolated to where it starts, from an equilibrium; `mixed` begins with that.

        Raises:
            NotConverged: on every rank, with the problem's displacement restored; `BeyondLaw` at an equilibrium.
        """
        problem = self.problem
        most = self.options.searches if strategy == "line search" else self.options.iterations
        start = problem.fields.u.x.array.copy()
        if not is_predicted or strategy != "mixed":
            problem.extrapolate_stress()
        first, moved, iteration, last, kept = None, np.inf, 0, np.inf, False
        while True:
            residual, _ = problem.residual()
            norm = residual.norm() / problem.force_scale
            first = norm if first is None else first
            # If steel is very stiff against the rubber, round-off keeps the residual up; the small motion by Newton's
            # method then shows that it has converged.
            rests = moved <= self.options.settled * problem.scene.geometry.length
            settled = rests and norm <= max(self.options.noise, ROUND_OFF * self.round_off())
            done = (norm <= self.options.tolerance or settled) and not kept
            exceeded = problem.limits.exceeded() if done else None
            if done and exceeded is None:
                residual.destroy()
                if problem.contact is not None and problem.contact.lets_go():
                    continue
                return iteration, self._linearisation() if iteration else None
            serves = iteration > 0 and strategy != "line search" and norm < self.options.near
            # The rest of a step with old factors is small in the residual, not yet in the soft finger: one step more.
            last_step = kept and (norm <= self.options.tolerance or settled)
            serves, last = last_step or (serves and norm <= self.options.contraction * last), norm
            kept = serves and not last_step
            reason = exceeded or (self._hopeless(norm, first, iteration, most) if not serves else None)
            if reason is None and not serves:
                reason, iteration = self._factorise(), iteration + 1
            if reason is None:
                self._factorisation.solve(residual, self._update)
                slope = -problem.copies * residual.dot(self._update)
                if not np.isfinite(slope):
                    reason = "the linear solver returned NaN"
                moved = self._update.norm(PETSc.NormType.NORM_INFINITY)  # whole, not what a search leaves of it
            if reason is None and strategy == "line search":
                reason = self._search(slope)
            residual.destroy()
            if reason is not None:
                is_beyond = exceeded is not None and problem.limits.smallest_of_cells() > 0
                problem.fields.u.x.array[:] = start
                raise (BeyondLaw if is_beyond else NotConverged)(reason, iteration)
            if strategy == "mixed":
                problem.extrapolate_stress(-self._update.array_r)
            self.add(-self._update.array_r)
            if strategy != "mixed":
                problem.extrapolate_stress()

    def round_off(self) -> float:
        """Error of the residual by rounding, over E A [-] (collective).

        The 2-norm of eps K_ii (|u_i| + h), with the diagonal of the last tangent and the shortest edge h. A
        displacement is rounded in proportion to itself, and F = 1 + grad u in proportion to 1. Steel's rows are most.
        """
        self.problem.matrix.getDiagonal(self._rounded)
        moved = np.abs(self.problem.displacement[: self._rounded.local_size])
        self._rounded.array[:] *= moved + self.problem.mesh.smallest
        return float(np.finfo(float).eps * self._rounded.norm() / self.problem.force_scale)

    def _search(self, slope: float) -> str | None:
        """Shorten the update until the potential falls as its slope [J] promises (Armijo) and no cell turns over."""
        problem = self.problem
        at = problem.fields.u.x.array.copy()
        noise = 1e-12 * problem.force_scale * problem.scene.geometry.side  # [J]
        if slope > noise:
            return "the tangent is not positive definite: Newton's direction climbs"
        before = problem.energy()
        for _ in range(30):
            self.add(-self._update.array_r)
            falls = problem.energy() - before <= 1e-4 * slope + noise
            good = falls and problem.limits.smallest_of_cells() > 0
            problem.fields.u.x.array[:] = at
            if good:
                return None
            self._update.scale(0.5)
            slope /= 2
        return "no step along Newton's direction lowers the potential"

    def _hopeless(self, norm: float, first: float, iteration: int, most: int) -> str | None:
        if not np.isfinite(norm):
            return "the residual is not finite"
        if norm > self.options.divergence * max(first, 1e-6):
            return f"diverges: residual {norm:.1e} E A after {iteration} iterations"
        if iteration == most:
            return f"residual still {norm:.1e} E A after {iteration} iterations"
        return None

    def _factorise(self) -> str | None:
        self.problem.tangent()
        return self._factorisation.update(self.problem.unsymmetric())

    def _linearisation(self) -> Linearisation:
        return Linearisation(self._factorisation, self._antisymmetric)

    def linearise(self) -> Linearisation:
        """Newton's tangent at the problem's displacement.

        Raises:
            NotConverged: it is singular.
        """
        self.problem.extrapolate_stress()
        reason = self._factorise()
        if reason is not None:
            raise NotConverged(reason)
        return self._linearisation()

    def add(self, owned_values: np.ndarray) -> None:
        """Add this rank's owned values, shape (owned values,) [m], to the problem's displacement."""
        u = self.problem.fields.u.x
        u.array[: len(owned_values)] += owned_values
        u.scatter_forward()
