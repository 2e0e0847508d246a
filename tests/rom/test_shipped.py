"""The trained fingers that come with the repository: a rod of elements, and a surrogate of the paper's plane."""

from pathlib import Path

import numpy as np
import pytest

from rom import Surrogate, TouchedSegment
from rom.rod import touched_segment
from rom.surrogate import SHIPPED

MAKEFILE = Path(__file__).resolve().parents[2] / "Makefile"


@pytest.fixture(scope="module")
def finger() -> TouchedSegment:
    return TouchedSegment.load()


@pytest.fixture(scope="module")
def plane() -> Surrogate:
    return Surrogate.load()


@pytest.mark.parametrize(("file", "name"), [(touched_segment.SHIPPED, "model"), (SHIPPED, "plane")])
def test_they_are_small_enough_to_track_and_made_by_a_command(file, name):
    assert file.stat().st_size < 500_000
    text = MAKEFILE.read_text()
    assert f"-o rom/{file.name}" in text[text.index(f"\n{name}:\n") :].split("\n\n")[0]


def test_the_finger_is_better_than_its_mesh_and_was_measured_on_held_out_states(finger):
    left_out, measured = finger.rod.elements.provenance["left_out"], finger.rod.accuracy
    assert finger.scene["mesh"]["cells"] == [24, 6] and finger.scene["mesh"]["order"] == 2
    assert left_out["contact_force"]["p95"] < 0.02 and left_out["free_place_m"]["p95"] < 5e-5
    assert measured["contact_force"]["median"] < 0.005 and measured["contact_force"]["p95"] < 0.02
    answer = finger.evaluate([50.0, 20.0, 0.010])
    for quantity, error in answer.error.items():
        assert error == sum(part[quantity] for part in answer.error_parts.values()) > 0


def test_the_finger_is_made_of_clamp_interior_elements_and_plate(finger):
    (own,) = finger.rod.pieces
    assert [one.kind for one in own[:: len(own) - 1]] == ["plate", "clamp"]
    assert len(own) > 2 and {one.kind for one in own[1:-1]} == {"interior"}
    assert sum(one.length for one in own) == pytest.approx(finger.rod.rest[0])


def test_the_surrogate_of_the_plane_agrees_with_it_within_both_estimates(finger, plane):
    random = np.random.default_rng(7)
    lower, upper = plane.limits
    points = lower + (upper - lower) * random.random((400, 3))
    ours, theirs = finger.evaluate(points), plane.evaluate(points)
    felt = ours.inside & (ours.contact_force > 0.5) & (theirs.contact_force > 0.5)
    assert felt.sum() > 100
    apart = np.abs(ours.contact_force - theirs.contact_force)[felt]
    assert np.median(apart / ours.contact_force[felt]) < 0.003
    assert np.mean(apart <= (ours.error["contact_force"] + theirs.error["contact_force"])[felt]) > 0.9


def test_the_plane_s_error_was_measured_on_held_out_states(plane):
    assert plane.scene["name"] == "standard" and [one["name"] for one in plane.parameters] == ["F1", "F2", "d"]
    assert plane.accuracy["contact_force"]["p95"] < 0.02 and plane.accuracy["contact_force"]["median"] < 0.001


def test_its_mesh_is_better_than_the_draft_one(plane, surrogate):
    """The draft mesh errs by 3 % of the contact force in the median (docs/tradeoff.md)."""
    random = np.random.default_rng(7)
    lower, upper = plane.limits
    points = lower + (upper - lower) * random.random((400, 3))
    ours, theirs = plane.evaluate(points), surrogate.evaluate(points)
    felt = (ours.contact_force > 0.5) & (theirs.contact_force > 0.5)
    assert felt.sum() > 100
    assert np.median(np.abs(theirs.contact_force[felt] / ours.contact_force[felt] - 1)) < 0.06
    assert np.abs(ours.tip - theirs.tip).max() < 0.1 * np.abs(ours.tip).max()
