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


def test_states_of_another_mesh_measure_mesh_and_surrogate_together(surrogate, held_out):
    """The model that comes along, of order 2, in states of the draft mesh: the draft mesh's error, all but."""
    standard = Surrogate.load()
    report = check_against(standard, held_out)
    assert report["mesh"] == {"cells": [20, 5], "order": 1} and report["states"] == 200
    assert 0.02 < report["contact_force"]["median"] < 0.06 and report["contact_force"]["p95"] > 0.1
    own = check_against(surrogate, held_out)  # the same of its own mesh is the surrogate's part alone
    assert own["contact_force"]["median"] < 1e-3 and own["displacement"]["median"] < 1e-3
    assert own["contact_force"]["coverage"] > 0.9 > report["contact_force"]["coverage"]


def test_what_cannot_be_compared_is_said_in_one_line(surrogate, held_out, tmp_path):
    with pytest.raises(SnapshotError, match="must have the tendons of the model"):
        other = surrogate.scene | {"tendons": surrogate.scene["tendons"][:1]}
        check_against(type("Model", (), {"scene": other})(), held_out)
    done = subprocess.run([sys.executable, "-m", "rom", "check", "rom/finger.h5"], capture_output=True, text=True)
    assert done.returncode == 2 and done.stderr == "HELDOUT/ or --against FINER/ must be given, got neither\n"
