"""Held-out states at points that somebody chose."""

import subprocess

import numpy as np
import pytest
from farm import ROOT, command, run

from fingerfem import FingerModel, load_scene
from rom.dataset.snapshot_set import SnapshotSet

POINTS = [[0.006, 40.0, 8.0], [0.006, 45.0, 0.0], [0.020, 45.0, 0.0]]  # d, F1, F2


@pytest.mark.long
def test_they_are_the_full_order_model_s_states_there(scene, tmp_path):
    file = tmp_path / "points.csv"
    lines = ["d, F1, F2", *(",".join(map(str, point)) for point in POINTS), ""]
    file.write_text("\n".join(lines), encoding="utf-8-sig")  # as spreadsheets write it
    run(1, scene, tmp_path / "set", "--points", str(file))
    found, model = SnapshotSet(tmp_path / "set"), FingerModel(load_scene(scene))
    assert found.random("parameters").tolist() == [[f1, f2, d] for d, f1, f2 in POINTS]
    for k, (d, f1, f2) in enumerate(POINTS):
        state = model.solve([f1, f2], d, sensitivities=False)
        assert np.abs(state.tip - found.random("tip")[k]).max() < 1e-8
        assert abs(state.contact_force - found.random("contact_force")[k]) < 1e-4
    line = command(1, scene, tmp_path / "set", "--random", "3")
    done = subprocess.run(line, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 2 and "other held-out points" in done.stderr


@pytest.mark.parametrize(
    ("text", "words"),
    [
        pytest.param("", "columns must be F1,F2,d", marks=pytest.mark.long),
        ("F1,d\n1,2\n", "columns must be F1,F2,d, got F1,d"),
        pytest.param("F1,F2,d\n", "must have a line for each point, got none", marks=pytest.mark.long),
        pytest.param("F1,F2,d\n1,2\n", "must be numbers, got 1,2", marks=pytest.mark.long),
        pytest.param("F1,F2,d\n1,much,0.01\n", "must be numbers, got 1,much,0.01", marks=pytest.mark.long),
        ("F1,F2,d\n1,2,nan\n", "d must lie in"),
        pytest.param("F1,F2,d\n1,2,0.01\n".encode("utf-16"), "must be a text file in UTF-8", marks=pytest.mark.long),
        pytest.param("F1,F2,d\n1,2,0.01\n1000,2,0.01\n", "got 1000 in point 2", marks=pytest.mark.long),
    ],
)
def test_a_table_that_makes_no_sense_is_one_line(scene, tmp_path, text, words):
    file = tmp_path / "points.csv"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    line = command(1, scene, tmp_path / "set", "--points", str(file))
    done = subprocess.run(line, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 2 and words in done.stderr and "Traceback" not in done.stderr
    assert not (tmp_path / "set").exists()
