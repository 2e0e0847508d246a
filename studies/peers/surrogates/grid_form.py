"""TensorLy's CP decomposition of a grid of states, with splines along its axes."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline
from tensorly.decomposition import parafac

from studies.peers.surrogates.learning import Learned
from studies.peers.surrogates.states import HeldOut

RANK = 60  # products; fewer err more, 90 as much [-]
SWEEPS, CHANGE = 500, 1e-10  # most alternating steps, and the relative change of the error at which they end [-]


def decomposed(file: Path) -> tuple[Learned, HeldOut]:
    """A model in the grid's own coordinates, and test states in them, see grid_states.py."""
    with np.load(file) as stored:
        grid = stored["values"]
        nodes = [stored[f"axis_{k}"] for k in range(grid.ndim - 1)]
        tested = HeldOut(parameters=stored["points"], tip=stored["tip"], force=stored["force"])
    begun = time.process_time()
    size = np.abs(grid).reshape(-1, grid.shape[-1]).max(axis=0)
    weights, factors = parafac(grid / size, rank=RANK, n_iter_max=SWEEPS, tol=CHANGE, init="random", random_state=0)
    axes = [CubicSpline(own, factor) for own, factor in zip(nodes, factors, strict=False)]
    modes = factors[-1] * weights * size[:, None]
    seconds = time.process_time() - begun

    def ask(point: np.ndarray) -> np.ndarray:
        product = np.ones(RANK)
        for axis, x in zip(axes, point, strict=True):
            product = product * axis(x)
        return modes @ product

    kept = sum(factor.nbytes for factor in factors)
    return Learned(ask, kept, f"rank {RANK}", seconds), tested
