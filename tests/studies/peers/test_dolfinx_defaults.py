"""What docs/peers.md says of DOLFINx's and PETSc's own solvers."""

import numpy as np
import pytest
from petsc4py import PETSc

from studies.peers.speed.comparison import prepared
from studies.peers.speed.dolfinx_defaults import Equations, left_by_a_full_step, newton_solver, snes

NO_LIMITS = {"snes_linesearch_type": "basic", "snes_divergence_tolerance": 1e30}


@pytest.fixture(scope="module")
def problem():
    return prepared("draft").problem


def pulled(problem, make) -> tuple[int, np.ndarray]:
    """How many tangents a solver takes from rest to 100 N in one step, and where it ends [m]."""
    problem.displacement[:] = 0.0
    problem.set_loads(np.array([100.0, 0.0]), None)
    equations = Equations(problem)
    make(equations)()
    return equations.tangents, problem.displacement.copy()


def test_snes_without_a_line_search_and_limits_takes_the_newton_solver_s_steps(problem):
    options = PETSc.Options()
    for key, value in NO_LIMITS.items():
        options[key] = value
    try:
        count, end = pulled(problem, snes)
    finally:
        for key in NO_LIMITS:
            options.delValue(key)
    theirs, where = pulled(problem, newton_solver)
    assert count == theirs and np.abs(end - where).max() < 1e-10


def test_snes_does_not_leave_rest_with_its_line_search_as_a_full_step_lets_the_residual_grow(problem):
    assert left_by_a_full_step(problem, 1.0)["residual_grows"] > 1000
    with pytest.raises(RuntimeError, match="DIVERGED_MAX_IT"):
        pulled(problem, snes)
