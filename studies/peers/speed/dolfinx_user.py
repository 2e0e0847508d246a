"""How a user of DOLFINx goes from load to load: in the equal steps that take least."""

from __future__ import annotations

import contextlib
import time
from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from fingerfem.discretisation.problem import Problem
from studies.peers.speed.dolfinx_defaults import Equations, Make

HINT = 1e-2  # tension [N] that a new solver is given first, so that what is done once is done
MOST_STEPS = 64  # from one load to another
LEAST = 3  # factorisations that every step takes: one that finds nearly all, and two that bring it to round-off
FAILURES = RuntimeError, PETSc.Error  # of DOLFINx and of PETSc: no convergence, or no factors of a NaN

Load = tuple[np.ndarray, float | None]  # tensions [N], distance [m]


class NotReached(Exception):
    """A load that no number of steps led to; its text is of the attempt with the most."""


@dataclass(frozen=True)
class Way:
    """From one load to another, at its cheapest: steps, factorisations, core-seconds, and where it ends [m]."""

    steps: int
    factorisations: int
    seconds: float
    end: np.ndarray


class User:
    """Goes from load to load in equal steps.

    Args:
        problem: what is solved; its displacement is the start and the answer.
        equations: of it.
        make: the solver.

    Attributes:
        ways: those that were gone since the last rest.
    """

    def __init__(self, problem: Problem, equations: Equations, make: Make):
        self.problem, self._equations, self._make = problem, equations, make
        self.rest()

    def rest(self) -> None:
        """The finger undeformed and a new solver."""
        self.ways: list[Way] = []
        self.problem.displacement[:] = 0.0
        self._renew()

    def _renew(self) -> None:
        """Another solver, for one that has failed refuses later matrices; its symbolic factorisation, done once."""
        before = self.problem.displacement.copy()
        self.problem.displacement[:] = 0.0
        self.problem.set_loads(HINT * np.ones(len(self.problem.tensions)), None)
        self._solve = self._make(self._equations)
        with contextlib.suppress(*FAILURES):
            self._solve()
        self.problem.displacement[:] = before

    def go(self, origin: Load, target: Load) -> None:
        """In 1, 2, 4 ... steps until more of them take more; nothing but the cheapest counts.

        Raises:
            NotReached: it does not converge in any.
        """
        start, best, reason, steps = self.problem.displacement.copy(), None, "", 1
        while steps <= MOST_STEPS and (best is None or LEAST * steps < best.factorisations):
            self.problem.displacement[:] = start
            before, begun = self._equations.tangents, time.process_time()
            try:
                self._ramp(origin, target, steps)
            except FAILURES as failure:
                reason = " ".join(str(failure).split())
                self._renew()
            else:
                made, seconds = self._equations.tangents - before, time.process_time() - begun
                if best is not None and made >= best.factorisations:
                    break
                best = Way(steps, made, seconds, self.problem.displacement.copy())
            steps *= 2
        if best is None:
            raise NotReached(f"not in {MOST_STEPS} steps: {reason}")
        self.problem.displacement[:] = best.end
        self.problem.set_loads(*target)
        self.ways.append(best)

    def _ramp(self, origin: Load, target: Load, steps: int) -> None:
        for share in np.arange(1, steps + 1) / steps:
            distance = target[1]
            if distance is not None and origin[1] is not None:
                distance = origin[1] + share * (distance - origin[1])
            self.problem.set_loads(origin[0] + share * (target[0] - origin[0]), distance)
            self._solve()
        if self.problem.smallest_volume_ratio() <= 0:
            raise RuntimeError("a cell is turned inside out")
