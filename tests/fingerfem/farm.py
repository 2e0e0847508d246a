"""Runs of the farm in tests, and comparison of their sets."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from rom.dataset.snapshot_set import read_description, read_task

PATIENCE = 1800.0  # [s] after which a job counts as hanging, on a loaded machine too; tests assert no other time
ROOT = Path(__file__).resolve().parents[2]


def command(ranks: int, scene: Path, folder: Path, *options: str) -> list[str]:
    farm = [sys.executable, "-m", "fingerfem", "snapshots", str(scene), str(folder), "--json", *options]
    return ["mpirun", "-n", str(ranks), *farm]


def run(ranks: int, scene: Path, folder: Path, *options: str, **settings: str) -> dict:
    done = subprocess.run(
        command(ranks, scene, folder, *options),
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        env=os.environ | settings,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def assert_same_task(ours: dict, theirs: dict, tolerance: float = 0.0) -> None:
    """All but the time it took; with a tolerance, over a quantity's largest value, a hundredfold for derivatives.

    With a tolerance iterations are not compared either: on the way to a state, rounding may accept or halve a step.
    """
    assert ours.keys() == theirs.keys()
    for name in ours.keys() - ({"seconds", "iterations"} if tolerance else {"seconds"}):
        if ours[name].dtype.kind == "f" and tolerance:
            share = 100 * tolerance if name.endswith("jacobian") else tolerance
            # [N], [-], [m/m], [1/N]; the solver's own tolerance is 1e-7 N
            least = {"contact_force": 10.0, "displacement_jacobian": 1.0}
            size = np.nanmax(np.abs(theirs[name]), initial=least.get(name, 0.0))
            assert np.allclose(ours[name], theirs[name], rtol=0, atol=share * size, equal_nan=True), name
        else:
            assert np.array_equal(ours[name], theirs[name], equal_nan=ours[name].dtype.kind == "f"), name


def assert_same(one: Path, other: Path, tolerance: float = 0.0) -> None:
    tasks = read_description(one).tasks
    assert tasks == read_description(other).tasks
    for task in tasks:
        assert_same_task(read_task(one, task), read_task(other, task), tolerance)
