"""What is refused instead of a model that nobody should use, and how a model answers its own training states."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from terminal import ROOT

from rom import Surrogate
from rom.held_out import check
from rom.snapshots.plan import Plan
from rom.snapshots.schema import QUANTITIES
from rom.snapshots.snapshot_set import SnapshotSet, read_description, task_file

NAMES = {quantity.name for quantity in QUANTITIES}


def rom(*words: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "rom", *map(str, words)], cwd=ROOT, capture_output=True, text=True)


def with_scene(source: Path, folder: Path, **changes) -> Path:
    """A set whose scene has other values at some keys; its states are another set's."""
    shutil.copytree(source, folder, copy_function=lambda one, other: Path(other).symlink_to(one))
    table = json.loads((source / "set.json").read_text())
    table["scene"] |= changes
    table["fingerprint"] = "another"
    (folder / "set.json").unlink()
    (folder / "set.json").write_text(json.dumps(table))
    return folder


def with_few(source: Path, folder: Path, count: int) -> Path:
    """A set of which all states but the first ones have failed."""
    (folder / "tasks").mkdir(parents=True)
    for name in ("set.json", "body.npz"):
        shutil.copy(source / name, folder / name)
    for task in Plan(source, read_description(source)).lines:
        with np.load(task_file(source, task)) as stored:
            arrays = dict(stored)
        solved = arrays["converged"] & (np.cumsum(arrays["converged"]) <= count)
        count -= int(solved.sum())
        arrays["converged"], arrays["reason"] = solved, np.where(solved, "", "failed")
        for name, values in arrays.items():
            if name.removesuffix("_jacobian") in NAMES and values.dtype.kind == "f":
                values[~solved] = np.nan
        np.savez(task_file(folder, task), **arrays)
    return folder


@pytest.mark.parametrize(
    ("count", "told"),
    [(1, "contact states"), (3, "contact states"), (14, "different tensions"), (40, "different tensions")],
)
def test_a_set_of_few_states_is_refused_with_what_it_needs(trained, tmp_path, count, told):
    done = rom("build", with_few(trained / "training", tmp_path / "few", count), "-o", tmp_path / "model.h5")
    assert done.returncode == 2 and "Traceback" not in done.stderr
    assert told in done.stderr.splitlines()[-1] and "must have" in done.stderr.splitlines()[-1]
    assert not (tmp_path / "model.h5").exists()


def test_a_model_that_expects_errors_above_itself_is_written_only_by_force(trained, tmp_path, monkeypatch):
    from rom import __main__ as program

    file = tmp_path / "model.h5"
    program.check_expected(1.0, file, force=False)
    program.check_expected(5.2, file, force=True)
    with pytest.raises(SystemExit) as caught:
        program.check_expected(5.2, file, force=False)
    assert caught.value.code == 3
    monkeypatch.setattr("rom.snapshots.training_states.FEWEST", 0)
    few = with_few(trained / "training", tmp_path / "few", 7)
    words = {"folder": few, "output": file, "as_json": True}
    with pytest.raises(SystemExit) as caught:
        program.build(**words)
    assert caught.value.code == 3 and not file.exists()
    with pytest.raises(SystemExit) as caught:
        program.build(**words, force=True)
    assert caught.value.code == 0 and file.exists()


def test_a_set_whose_scene_names_a_coarse_mesh_asks_for_the_coarse_set(trained, tmp_path):
    fine = with_scene(trained / "training", tmp_path / "fine", coarse={"cells": [10, 4], "order": 1, "lines": 3})
    done = rom("build", fine, "-o", tmp_path / "model.h5")
    assert done.returncode == 2 and done.stderr.count("\n") == 1, done.stderr
    assert done.stderr.startswith("coarse must be given") and "snapshots --coarse" in done.stderr
    assert list(tmp_path.iterdir()) == [fine]


@pytest.mark.parametrize("kind", ["training", "heldout"])
def test_a_set_of_another_scene_names_the_key_that_differs(trained, tmp_path, kind):
    scene = read_description(trained / kind).scene
    other = with_scene(trained / kind, tmp_path / "other", geometry=scene["geometry"] | {"side": 0.0175})
    done = rom("check", trained / "finger.h5", other)
    assert done.returncode == 2 and done.stderr.count("\n") == 1
    assert done.stderr.rstrip().endswith(f"geometry.side must be {scene['geometry']['side']}, got 0.0175")
    if kind == "heldout":
        done = rom("build", trained / "training", "-o", tmp_path / "model.h5", "--held-out", other)
        assert done.returncode == 2 and "geometry.side must be" in done.stderr.splitlines()[-1]


def test_training_states_are_within_their_estimate_and_check_counts_them(trained):
    model, training = Surrogate.load(trained / "finger.h5"), SnapshotSet(trained / "training")
    report = check(model, training)
    assert report["training"] and report["states"] == training.states == 731
    for name in ("tip", "displacement", "touch_distance", "contact_force"):
        assert report[name]["coverage"] >= 0.945, name  # of as many states as have the quantity
        assert report[name]["median"] < 1e-3
    assert report["touch"]["wrong_beyond_margin"] == 0  # contact paths begin at touch
    printed = rom("check", trained / "finger.h5", trained / "training")
    assert printed.returncode == 0 and printed.stdout.startswith("731 training states, 0 failed")
