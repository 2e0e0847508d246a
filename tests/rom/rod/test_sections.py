"""Poses of cross-sections along a finger, free and pressed, against an elastic rod and the elements' own laws."""

import numpy as np
import pytest
from assembled import in_series

from rom import TouchedSegment
from rom.elements import rotation_vectors
from rom.files.checked_file import ModelError
from rom.rod import shape
from tests.rom.elements import elastic_rod as rod

WRENCH = np.array([[-0.1, 0.3, 0.2, 3e-4, 1e-3, -2e-3]])
PLACE, TURN = 5e-6, 5e-4  # differences of elements and rod [m, -]


@pytest.mark.parametrize("wrench", [0 * WRENCH, WRENCH], ids=["free", "pressed"])
def test_sections_are_those_of_an_elastic_rod(finger, wrench):
    tensions, at = np.array([9.0, 4.0]), np.arange(0.0, rod.LENGTH - rod.PLATE + 1e-9, 2 * rod.STEP)
    places, turned, _ = rod.in_space(np.concatenate([tensions, wrench[0]])[None], rod.LENGTH)
    found = finger.sections(tensions, wrench, at)
    assert found.at == pytest.approx(at)
    assert np.abs(found.centres - places[0, ::2][: len(at)]).max() < PLACE
    assert np.abs(found.rotations - turned[0, ::2][: len(at)]).max() < TURN


def test_sections_in_plates_are_rigid_and_the_first_is_the_clamp():
    own = in_series(TouchedSegment.load().rod, 2)
    tensions, length, half = [12.0, 7.0], 0.05, own.half_lengths[0]
    plates = own.place(tensions)
    found = own.sections(tensions, at=[0.0, length - 2 * half, length - half, length, 2 * length - half, 2 * length])
    assert found.centres[0] == pytest.approx(np.zeros(3), abs=1e-12)
    assert found.rotations[0] == pytest.approx(np.eye(3), abs=1e-12)
    for k, plate in ((1, 0), (2, 0), (3, 0), (4, 1), (5, 1)):
        offset = found.at[k] - (length * (plate + 1) - half)
        assert found.centres[k] == pytest.approx(
            plates.centres[plate] + offset * plates.rotations[plate][:, 0], abs=1e-9
        )
        assert found.rotations[k] == pytest.approx(plates.rotations[plate], abs=1e-9)


def test_sections_are_where_the_law_of_an_interior_element_has_them():
    own = TouchedSegment.load().rod
    tensions, wrench = np.array([20.0, 6.0]), np.array([[0.0, -1.0, 0.0, 0.0, 0.0, 0.0]])
    interior = [one for one in shape.placed(own, tensions, wrench) if one.piece.kind == "interior"]
    assert len(interior) > 1
    for one in interior:
        for distance in np.linspace(0.0, one.length, 4):
            pose = own.own.laws["interior"].of_length(distance).value(one.inputs[None])[0]
            found = own.sections(tensions, wrench, [one.at - distance])
            assert found.centres[0] == pytest.approx(one.place + one.rotation @ pose[:3], abs=1e-12)
            turned = one.rotation @ rotation_vectors.matrices(pose[3:6])
            assert found.rotations[0] == pytest.approx(turned, abs=1e-12)


def test_without_an_interior_element_sections_are_those_of_the_corners(monkeypatch):
    """As of fingers in one piece: the best rigid fit of the corners is near the law of the others."""
    own = TouchedSegment.load().rod
    tensions, wrench = np.array([20.0, 6.0]), np.array([[0.0, -1.0, 0.0, 0.0, 0.0, 0.0]])
    known = own.sections(tensions, wrench)
    monkeypatch.setattr(shape, "INTERIOR", "none")
    fitted = own.sections(tensions, wrench)
    assert 0 < np.abs(fitted.centres - known.centres).max() < 5e-5
    assert 0 < np.abs(fitted.rotations - known.rotations).max() < 5e-3


def test_sections_of_a_pressed_finger_end_at_its_tip_and_are_rotations():
    model = TouchedSegment.load()
    point = [30.0, 5.0, 0.01]
    found, answer = model.sections(point), model.evaluate(point)
    assert answer.contact_force > 0.1
    plate = model.sections(point, [model.rod.rest[0]])
    assert plate.centres[0] - model.rod.rest == pytest.approx(answer.tip, abs=1e-7)
    identities = np.einsum("kji,kjl->kil", found.rotations, found.rotations)
    assert identities == pytest.approx(np.broadcast_to(np.eye(3), identities.shape), abs=1e-12)
    steps = np.linalg.norm(np.diff(found.centres, axis=0), axis=1) / np.diff(found.at)
    assert (steps > 0.7).all() and (steps < 1.05).all()  # pulled tendons compress the finger


@pytest.mark.parametrize("at", [[-1e-3], [0.051], [np.nan]])
def test_a_position_that_is_none_of_the_finger_is_refused(at):
    with pytest.raises(ModelError, match=r"at must lie between clamp and tip, 0 to 0\.05 m, got"):
        TouchedSegment.load().rod.sections([0.0, 0.0], at=at)


def test_the_surface_goes_on_from_element_to_element():
    """At a section between elements it is as deformed as beside it."""
    finger, half = TouchedSegment.load().rod, 0.005
    ends = np.cumsum([piece.length for piece in finger.pieces[0][::-1]])[:-1]
    corners = [
        [x + off, y, z] for x in ends for off in (-1e-7, 0.0, 1e-7) for y in (-half, half) for z in (-half, half)
    ]
    moved = finger.displacement([60.0, 20.0], points=corners).reshape(len(ends), 3, 4, 3)
    assert np.abs(moved[:, 1] - moved[:, 0]).max() < 3e-5 and np.abs(moved[:, 2] - moved[:, 1]).max() < 3e-5
