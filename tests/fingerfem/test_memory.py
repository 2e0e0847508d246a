"""One solver per model, used again and again, keeps nothing."""

import resource

import numpy as np

from fingerfem import FingerModel
from fingerfem.scene import Scene


def test_a_thousand_solves_leave_memory_flat(table):
    """Peak resident memory after 100 solves and after 1,000; one vector kept a solve would be 8 MB."""
    table["mesh"]["cells"] = [10, 5]
    model = FingerModel(Scene.model_validate(table))
    assert 8 * model.unknowns * 900 > 8e6
    random = np.random.default_rng(0)
    peaks = []
    for k in range(1000):
        model.solve(random.uniform(0, 3, 2), random.uniform(0.002, 0.03) if k % 2 else None)
        if k in (99, 999):
            peaks.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)  # [MB]
    assert peaks[1] - peaks[0] < 4
