"""One solver per model, used again and again, keeps nothing."""

import resource
from pathlib import Path

import numpy as np
import pytest
from petsc4py import PETSc

from fingerfem import FingerModel, load_scene
from fingerfem.equilibrium.factorisation import Factorisation


@pytest.mark.parametrize("solves", [pytest.param(one, marks=pytest.mark.long) for one in (300, 1000)])
def test_many_solves_leave_memory_flat(scene, solves):
    """Peak resident memory after 100 solves and after all; it grows by less than half of a vector for every solve."""
    model, random, peaks = FingerModel(load_scene(scene)), np.random.default_rng(0), []
    for k in range(solves):
        model.solve(random.uniform(0, 3, 2), random.uniform(0.002, 0.03) if k % 2 else None)
        if k in (99, solves - 1):
            peaks.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)  # [MB]
    kept = 8 * model.problem.unknowns * (solves - 100) / 1e6  # [MB]
    assert peaks[1] - peaks[0] < kept / 2


def test_tangents_that_are_not_definite_leave_memory_flat(draft):
    """PETSc would leave a copy of each behind if CHOLMOD got the whole of it."""

    def resident() -> float:
        return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() / 1e6

    draft.continuation.rest()  # other tests leave it in any state
    draft.continuation.linearise()
    definite = draft.problem.matrix.copy()
    indefinite, matrix = definite.copy(), definite.copy()
    indefinite.shift(-2e4)
    factors, sizes = Factorisation(matrix), []
    for k in range(200):
        (indefinite if k % 2 else definite).copy(matrix, structure=PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        assert factors.update() is None and (factors.negative_pivots > 0) == bool(k % 2)
        if k in (39, 199):
            sizes.append(resident())
    copy = 12 * definite.getInfo()["nz_used"] / 2 / 1e6  # [MB]
    assert sizes[1] - sizes[0] < 5 * copy  # of eighty
