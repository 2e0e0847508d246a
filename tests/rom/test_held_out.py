"""Held-out states either calibrate or test."""

import subprocess
import sys

import numpy as np
import pytest

from rom import Surrogate
from rom.held_out import check, check_against, split
from rom.snapshots.snapshot_set import SnapshotError


def test_calibration_and_test_states_are_all_and_none_twice(held_out):
    calibration, test = (half.random("parameters") for half in split(held_out))
    assert len(calibration) == len(test) == len(held_out.random("parameters")) / 2
    both = np.concatenate([calibration, test])
    assert len(np.unique(both, axis=0)) == len(both)


def test_states_that_share_tensions_are_on_one_side(held_out):
    sides = [{tuple(point[:-1]) for point in half.random("parameters")} for half in split(held_out)]
    assert not sides[0] & sides[1]


def test_check_leaves_out_what_calibrated_the_model(surrogate, held_out):
    calibration, test = split(held_out)
    report = check(surrogate, held_out)
    assert report["states"] == len(test.random("parameters"))
    assert report["calibration_states"] == len(calibration.random("parameters"))
    force = test.random("contact_force")
    errors = np.abs(surrogate.evaluate(test.random("parameters")).contact_force - force)
    assert report["contact_force"]["p95_absolute"] == np.percentile(errors[force > 0.1], 95)


def test_what_cannot_be_compared_is_said_in_one_line(surrogate, held_out, tmp_path):
    for model in (surrogate, Surrogate.load()):  # of the set's own mesh, and of a finer one
        with pytest.raises(SnapshotError, match="must be of a finer mesh than the model's"):
            check_against(model, held_out)
    with pytest.raises(SnapshotError, match="must have the tendons of the model"):
        other = surrogate.scene | {"tendons": surrogate.scene["tendons"][:1]}
        check_against(type("Model", (), {"scene": other})(), held_out)
    done = subprocess.run([sys.executable, "-m", "rom", "check", "rom/finger.h5"], capture_output=True, text=True)
    assert done.returncode == 2 and done.stderr == "SET/ or --against FINER/ must be given, got neither\n"
