"""FElupe's viscoelastic branch, of another theory at finite strain, is ours as strains become small."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from fingerfem.dynamics.moving_problem import MovingProblem
from fingerfem.scene.scene import Scene
from studies.peers.felupe.comparison import FELUPE, ROOT

pytestmark = pytest.mark.skipif(
    not (FELUPE / "felupe").exists(), reason="FElupe is not in its folder: make out/peers/felupe/ready"
)
E, NU, SHARE, TAU, STEP, STEPS = 1e6, 0.3, 0.5, 0.02, 5e-5, 1200  # [Pa], [-], [-], [s], [s]
MU = E / (2 * (1 + NU))


def history(strain: float) -> np.ndarray:
    """Stretch and shear that rise for 20 ms and are held for 40 ms, shape (steps, 3, 3)."""
    share = np.minimum(np.arange(1, STEPS + 1) * 3 / STEPS, 1.0)
    way = np.array([[1.0, 0.7, 0.0], [0.0, -0.4, 0.3], [0.0, 0.0, -0.4]])
    return np.eye(3) + strain * share[:, None, None] * way


def felupe_s(gradients: np.ndarray, folder: Path) -> np.ndarray:
    given, wanted = folder / "asked.npz", folder / "answered.npz"
    np.savez(given, history=gradients, time=STEP, mu=SHARE * MU, eta=SHARE * MU * TAU)
    variables = os.environ | {"OMP_NUM_THREADS": "1", "PYTHONPATH": os.pathsep.join([str(ROOT), str(FELUPE)])}
    words = [sys.executable, "-m", "studies.peers.felupe.viscoelastic", str(given), str(wanted)]
    subprocess.run(words, check=True, env=variables, cwd=ROOT)
    with np.load(wanted) as file:
        return file["stresses"]


def ours(gradients: np.ndarray) -> np.ndarray:
    """Stresses of a finger that is deformed alike everywhere."""
    table = {
        "name": "block",
        "geometry": {"side": 0.01, "segments": [0.05], "plate": 0.001, "channel": 0.01 / 3},
        "material": {"law": "neo-hookean", "E": E, "nu": NU, "prony": [[SHARE, TAU]]},
        "density": {"rubber": 1100.0},
        "tendons": [{"name": "F1", "offset": [0.01 / 3, 0.0], "segment": 1, "tension": [0.0, 10.0]}],
        "mesh": {"cells": [9, 3]},
    }
    problem, stresses = MovingProblem(Scene.model_validate(table)), []
    cell = int(np.argmin(problem.mesh.midpoints[0]))
    for F in gradients:
        problem.branches.begin(STEP)
        problem.displacement[:] = (problem.rest @ (F - np.eye(3)).T).ravel()
        problem.branches.settle(STEP)
        stresses.append(F @ problem.branches.stresses[0, cell, 0])
    return np.array(stresses)


def test_both_branches_have_the_same_stress_as_strains_become_small(tmp_path):
    differences = []
    for strain in (0.04, 0.01):
        gradients = history(strain)
        one, other = ours(gradients), felupe_s(gradients, tmp_path)
        assert np.abs(other).max() > 0.5 * SHARE * MU * strain and np.abs(one[-1]).max() < 0.3 * np.abs(one).max()
        differences.append(np.abs(one - other).max() / np.abs(other).max())
    assert differences[0] < 0.03 and differences[1] < 0.01  # of which FElupe's implicit steps are 0.0025
    assert differences[1] < 0.5 * differences[0]
