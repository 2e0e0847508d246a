"""Fingers of several segments against a rod that is marched through all of them at once."""

import numpy as np
import pytest

from rom.files.checked_file import ModelError
from rom.rod.objects.shapes import Plane, RigidObject, Sphere, box, facing_plane
from rom.rod.touched_segment import TouchedSegment
from tests.rom.elements import elastic_rod as rod
from tests.rom.rod.plates import bare, touch_of_plates

TENSIONS = np.array([6.0, 3.0])
WRENCHES = np.array([[0.1, -0.2, 0.15, 2e-4, -3e-4, 2e-4], [-0.1, 0.12, 0.05, 3e-4, 1e-4, -2e-4]])
ROUGH = 1e-6  # difference of elements and rod [m]


@pytest.fixture(scope="module")
def two(finger):
    return finger.assembled(rod.in_series(rod.LENGTH, rod.LENGTH))


def whole(tensions: np.ndarray, wrenches: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Centres and rotations of two plates of a rod, the tip's wrench carried on to the first plate by statics."""
    tip, turned = rod.plate(tensions, wrenches[1])
    arm, force = tip + np.array([rod.PLATE / 2, 0, 0]), turned @ wrenches[1, :3]
    transmitted = wrenches[0] + np.concatenate([force, turned @ wrenches[1, 3:] + np.cross(arm, force)])
    centre, first = rod.plate(tensions, transmitted)
    return [(centre, first), (centre + first @ arm, first @ turned)]


def test_a_finger_of_one_segment_is_its_segment(finger):
    centre, rotation, motion, inside = finger.segments[0].place([*TENSIONS, *WRENCHES[0]])
    placed = finger.place(TENSIONS, WRENCHES[:1])
    assert placed.centres[0] == pytest.approx(centre) and placed.rotations[0] == pytest.approx(rotation)
    assert placed.motions[0] == pytest.approx(motion) and placed.inside == inside


def test_motions_are_those_of_differences(finger):
    three = finger.assembled(rod.in_series(*[rod.LENGTH] * 3))
    wrenches = np.vstack([WRENCHES, 0.3 * WRENCHES[:1]])
    placed = three.place(TENSIONS, wrenches)
    for k, h in enumerate([1e-3] * 2 + ([1e-4] * 3 + [1e-6] * 3) * 3):
        unit = h * np.eye(20)[k]
        before, after = (three.place(TENSIONS + s * unit[:2], wrenches + s * unit[2:].reshape(3, 6)) for s in (-1, 1))
        for plate in range(3):
            turned = placed.rotations[plate]
            spin = turned.T @ (after.rotations[plate] - before.rotations[plate]) / (2 * h)
            moved = turned.T @ (after.centres[plate] - before.centres[plate]) / (2 * h)
            found = np.concatenate([moved, [spin[2, 1], spin[0, 2], spin[1, 0]]])
            assert placed.motions[plate, :, k] == pytest.approx(found, rel=1e-4, abs=1e-5 * np.abs(found).max())


def test_inputs_of_the_wrong_number_are_refused(two):
    with pytest.raises(ModelError, match=r"must be 2 tensions and wrenches of shape \(2, 6\), got shapes \(1,\)"):
        two.place([1.0])
    with pytest.raises(ModelError, match="inputs must be F1, F2 and a wrench, got shape"):
        two.segments[0].place([1.0, 2.0])


WHERE = {"direction": (0.0, 1.0, 0.0), "distances": (0.0, 0.1)}
# What touches, and which plates.
OBJECTS = {"plane": {1}, "ball at the middle": {0}, "plane along both": {0, 1}, "box": {1}}


def pressed(two, name: str) -> tuple[TouchedSegment, np.ndarray]:
    """A finger of two segments and what touches it, at tensions and a distance."""
    tensions, two = np.array([3.0, 1.0]), bare(two)
    placed = two.place(tensions)
    base, tip = (c + rod.CORNERS @ R.T for c, R in zip(placed.centres, placed.rotations, strict=True))
    base, tip = (places[np.argmax(places[:, 1])] for places in (base, tip))
    found: RigidObject
    if name == "plane":
        found = facing_plane(rod.SIDE, (0.0, 0.1))
    elif name == "plane along both":  # which presses the tip further than it is moved by the middle
        along = tip - np.array([0, 0.00065, 0]) - base
        found = Plane(centre=tuple(base - [0, 0.05, 0]), normal=(along[1], -along[0], 0.0), **WHERE)
    elif name == "box":
        found = box(
            centre=tuple(tip + np.array([0.008, -0.02, 0])), sides=(0.02, 0.01, 0.02), rotation=(0.1, 0.2, 0.3), **WHERE
        )
    else:
        found = Sphere(centre=tuple(base - [0, 0.05 - 0.004, 0]), radius=0.004, **WHERE)
    model = TouchedSegment(rod=two, obstacle=found)
    return model, np.array([*tensions, touch_of_plates(model, [*tensions, 0.1]) - 1e-3])


@pytest.mark.parametrize("name", OBJECTS)
def test_an_object_presses_on_whichever_plate_it_touches(two, name):
    """Against the rod under the wrenches that were found: no corner is behind a plane, those that press are on it."""
    model, point = pressed(two, name)
    found = model.answers(point)
    wrenches = found.wrenches[0].reshape(2, 6)
    assert found.evaluations[0] > 0 and found.out[0, 3] > 0.01
    assert found.inside[0]
    assert set(np.flatnonzero(np.abs(wrenches[:, :3]).max(axis=1) > 1e-9)) == OBJECTS[name]
    total = np.zeros(3)
    for wrench, (centre, turned) in zip(wrenches, whole(point[:2], wrenches), strict=True):
        force = turned @ wrench[:3]
        total += force
        if isinstance(model.obstacle, Plane):
            away = np.array(model.obstacle.normal) / np.linalg.norm(model.obstacle.normal)
            place = np.array(model.obstacle.centre) + point[2] * np.array(model.obstacle.direction)
            gap = float(((centre + rod.CORNERS @ turned.T - place) @ away).min())
            assert gap > -ROUGH and (np.linalg.norm(force) < 1e-9 or gap < ROUGH)
            assert np.cross(force, away) == pytest.approx(np.zeros(3), abs=1e-4 * np.linalg.norm(force))
    assert found.out[0, 3] == pytest.approx(-total @ model.obstacle.numbers()["direction"], rel=1e-4)


@pytest.mark.parametrize("name", OBJECTS)
def test_derivatives_of_a_touched_finger_are_those_of_its_answers(two, name):
    model, point = pressed(two, name)
    jacobian = model.jacobian(point)
    for k, h in enumerate((2e-4, 2e-4, 2e-8)):
        unit = h * np.eye(3)[k]
        differences = (model.outputs(point + unit)[0] - model.outputs(point - unit)[0]) / (2 * h)
        assert jacobian[:, k] == pytest.approx(differences, rel=5e-4, abs=5e-4 * np.abs(differences[:3]).max())
