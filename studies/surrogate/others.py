"""EZyRB and TensorLy beside this project, on the states of states.py, in a virtual environment that has all three.

python -m studies.surrogate.others    measures the part surrogate/others of `make docs`, which calls it
"""

from __future__ import annotations

import pickle
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from rom.surrogate import Surrogate
from studies.runner import OUT, Run, finished, place, say

CALLS = 300  # single queries that are timed
RANK = 60


def row(package: str, method: str, predict, fresh: np.ndarray, force: np.ndarray, size: int) -> dict:
    """Error of the contact force, and time of single queries."""
    off = np.abs(np.array([predict(point)[3] for point in fresh]) - force) / force
    taken = []
    for k in range(CALLS):
        begun = time.perf_counter_ns()
        predict(fresh[k % len(fresh)])
        taken.append(time.perf_counter_ns() - begun)
    return {
        "package": package,
        "method": method,
        "median": float(np.median(off)),
        "p95": float(np.percentile(off, 95)),
        "max": float(off.max()),
        "p50_us": float(np.percentile(taken, 50)) / 1e3,
        "p99_us": float(np.percentile(taken, 99)) / 1e3,
        "bytes": size,
    }


def ezyrb(stored) -> list[dict]:
    """POD of the outputs with radial basis functions and with Gaussian processes."""
    from ezyrb import GPR, POD, RBF, Database, ReducedOrderModel

    found = []
    size = np.abs(stored["outputs"]).max(axis=0)
    for name, approximation in (("POD, RBF", RBF()), ("POD, GPR", GPR())):
        model = ReducedOrderModel(Database(stored["parameters"], stored["outputs"] / size), POD("svd"), approximation)
        model.fit()

        def predict(point, model=model):
            said = model.predict(point[None])
            return np.ravel(getattr(said, "snapshots_matrix", said)) * size

        found.append(row("EZyRB", name, predict, stored["scaled"], stored["force"], len(pickle.dumps(model))))
    return found


def tensorly(stored) -> list[dict]:
    """Its CP of the grid of contact states, in contact-aligned coordinates, with splines along every axis."""
    from tensorly.decomposition import parafac

    grid = stored["grid"]
    size = np.abs(grid).reshape(-1, grid.shape[-1]).max(axis=0)
    weights, factors = parafac(grid / size, rank=RANK, n_iter_max=500, tol=1e-10, init="random", random_state=0)
    axes = [CubicSpline(stored[f"nodes_{k}"], factors[k]) for k in range(grid.ndim - 1)]
    modes = factors[-1] * weights * size[:, None]

    def predict(point):
        product = np.ones(RANK)
        for axis, x in zip(axes, point, strict=True):
            product = product * axis(x)
        return modes @ product

    kept = sum(factor.nbytes for factor in factors)
    return [row("TensorLy", f"CP, rank {RANK}", predict, stored["aligned"], stored["force"], kept)]


def fingerfem(stored, file: Path) -> list[dict]:
    """This project's model: value and derivatives."""
    model = Surrogate.load(file)

    def predict(point):
        return model.value_and_jacobian(point)[0]

    size = replace(model, displacements=None).bytes
    return [row("fingerfem", "regimes, separated", predict, stored["points"], stored["force"], size)]


def measure(run: Run) -> list[dict]:
    """All of them, in one process."""
    with np.load(run.folder / "others.npz") as states:
        rows = fingerfem(states, run.folder / "others.h5") + ezyrb(states) + tensorly(states)
    for one in rows:
        say(one)
    return rows


if __name__ == "__main__":
    own, began = place("surrogate/others", OUT, quick=False), time.perf_counter()
    finished(own, measure(own), time.perf_counter() - began)
