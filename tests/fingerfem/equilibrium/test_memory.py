"""One solver per model, used again and again, keeps nothing."""

import resource

import numpy as np
import pytest

from fingerfem import FingerModel, load_scene


@pytest.mark.parametrize("solves", [300, pytest.param(1000, marks=pytest.mark.long)])
def test_many_solves_leave_memory_flat(scene, solves):
    """Peak resident memory after 100 solves and after all; it grows by less than half of a vector for every solve."""
    model, random, peaks = FingerModel(load_scene(scene)), np.random.default_rng(0), []
    for k in range(solves):
        model.solve(random.uniform(0, 3, 2), random.uniform(0.002, 0.03) if k % 2 else None)
        if k in (99, solves - 1):
            peaks.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)  # [MB]
    kept = 8 * model.problem.unknowns * (solves - 100) / 1e6  # [MB]
    assert peaks[1] - peaks[0] < kept / 2
