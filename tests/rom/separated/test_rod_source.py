"""The table of a finger before one object: like the finger within its estimated errors, marked where the finger is."""

import json
from dataclasses import replace

import numpy as np
import pytest
from terminal import ran

from control import Finger
from rom import SeparatedModel, Sphere, TouchedSegment
from rom.separated.alternating_directions import EnrichmentOptions
from rom.separated.rod_source import measured, specialise
from tests.rom.rod.plates import bare

NODES = 12


@pytest.fixture(scope="module")
def whole():
    """The bundled finger before the paper's plane, d from 1 mm."""
    loaded = TouchedSegment.load()
    return replace(loaded, obstacle=replace(loaded.obstacle, distances=(0.001, 0.031)))


@pytest.fixture(scope="module")
def finger(whole):
    """The same, of which the plate alone can be touched."""
    return replace(whole, rod=bare(whole.rod))


@pytest.fixture(scope="module")
def table(finger):
    return specialise(finger, NODES)


@pytest.fixture(scope="module")
def points(finger):
    lower, upper = finger.limits
    return lower + np.random.default_rng(77).random((4000, 3)) * (upper - lower)


def test_it_is_the_finger_within_its_estimated_errors(table, finger):
    found = measured(table, finger, np.random.default_rng(5), 20_000)
    assert found["contact_force"]["median"] < 0.01 and found["contact_force"]["p95"] < 0.08
    assert found["tip"]["median"] < 1e-3 and found["touch_distance"]["decided"] > 0.995
    assert all(found[name]["coverage"] > 0.95 for name in ("tip", "contact_force", "touch_distance"))
    assert found["contact_force"]["count"] > 5_000


def test_more_nodes_and_terms_are_more_accurate(table, finger):
    fewer = specialise(finger, 6, EnrichmentOptions(tolerance=1e-5, terms=8))
    assert fewer.accuracy["contact_force"]["median"] > 2 * table.accuracy["contact_force"]["median"]


def test_where_the_finger_has_no_answer_the_table_is_marked(whole, points):
    ours, truth = specialise(whole, NODES).evaluate(points), whole.evaluate(points)
    assert np.mean(ours.inside & ~truth.inside) < 1e-3
    assert np.mean(ours.inside) > np.mean(truth.inside) - 0.08
    pressed = ~ours.inside & (ours.contact_force > 0)
    assert pressed.any() and np.isinf(ours.error["contact_force"][pressed]).all()


def test_a_force_that_it_holds_is_the_fingers_own(table, finger):
    motion = Finger(table).hold(contact_force=1.0, distance=0.010)
    assert motion.status == "converged"
    truth = finger.evaluate([*motion.tensions, 0.010])
    assert truth.inside and abs(truth.contact_force - 1.0) < motion.error


@pytest.mark.long
def test_a_ball_has_a_table_too_and_its_file_is_the_same_model(whole, tmp_path):
    ball = Sphere(centre=(0.046, 0.031, 0.001), radius=0.026, direction=(0, 1, 0), distances=(0.001, 0.020))
    found = specialise(replace(whole, obstacle=ball), 16)
    assert found.accuracy["contact_force"]["median"] < 0.05 and found.accuracy["contact_force"]["coverage"] > 0.95
    found.save(tmp_path / "ball.h5")
    read, at = SeparatedModel.load(tmp_path / "ball.h5"), np.array([[60.0, 5.0, 0.004], [30.0, 30.0, 0.012]])
    assert np.array_equal(read.outputs(at), found.outputs(at))


@pytest.mark.long
def test_kinks_of_touch_do_not_leave_all_bounds_between_the_nodes():
    """Two corners touch at once where tensions are 0, and slopes just past touch are those of one side."""
    tendons = [
        {"name": name, "offset": offset, "segment": segment, "tension": [0.0, 40.0]}
        for name, offset, segment in (("A", [0.004, 0.0], 1), ("B", [0.0, 0.004], 2))
    ]
    loaded = TouchedSegment.load()
    geometry = loaded.scene["geometry"] | {"segments": [0.05, 0.05]}
    rod = loaded.rod.assembled(loaded.scene | {"geometry": geometry, "tendons": tendons})
    two = TouchedSegment(rod=rod, obstacle=replace(loaded.obstacle, distances=(0.001, 0.06)))
    found = specialise(two, 8)
    lower, upper = two.limits
    points = lower + np.random.default_rng(5).random((1000, 3)) * (upper - lower)
    ours, truth = found.evaluate(points), two.evaluate(points)
    both = ours.inside & truth.inside
    assert both.mean() > 0.7 and np.abs(ours.tip - truth.tip)[both].max() < 0.02
    assert np.abs(ours.contact_force - truth.contact_force)[both].max() < 2.0
    assert ours.error["contact_force"][both].max() < 1.1 * truth.contact_force.max()


@pytest.mark.parametrize(
    ("distances", "message"),
    [
        ((0.0385, 0.04), r"d must begin below 0\.0304\d m, where the finger touches, got 0\.0385 m"),
        ((0.02, 0.01), "d must have a range of at least 5e-05 m"),
        ((0.01, 0.01000001), "d must have a range of at least 5e-05 m"),
        ((0.03, 0.04), "must have contact forces at 20 of 8000 points at least"),
    ],
)
def test_a_range_of_d_without_a_table_is_refused_in_one_line(finger, distances, message):
    with pytest.raises(ValueError, match=message):
        specialise(replace(finger, obstacle=replace(finger.obstacle, distances=distances)), 4)


def test_an_object_that_the_finger_passes_and_too_few_nodes_are_refused(finger):
    ball = Sphere(centre=(0.046, 0.011, 0.001), radius=0.006, direction=(0, 1, 0), distances=(0.001, 0.020))
    with pytest.raises(ValueError, match="object must be in the way of the finger at all tensions"):
        specialise(replace(finger, obstacle=ball), 8)
    with pytest.raises(ValueError, match="nodes must be at least 4, got 3"):
        specialise(finger, 3)


def test_the_command_writes_a_table_that_other_commands_take(tmp_path):
    file = tmp_path / "table.h5"
    done = ran("rom", "specialise", "rom/finger.h5", "-o", file, "--nodes", "6", "--json")
    assert done.returncode == 0, done.stderr
    summary = json.loads(done.stdout)
    assert (
        summary["parameters"][-1]["lower"] == pytest.approx(0.001) and summary["accuracy"]["contact_force"]["count"] > 0
    )
    held = ran("control", "hold", file, "--distance", "0.0105", "--contact-force", "0.7", "--json")
    assert json.loads(held.stdout)["status"] == "converged", held.stderr
    described = ran("rom", "info", file).stdout
    assert "samples of the finger before one object" in described
    wrong = ran("rom", "specialise", "rom/finger.h5", "-o", file, "--distances", "0.02", "0.01")
    assert wrong.returncode == 2 and "distances must be two from 0 to 0.05 m" in wrong.stderr
