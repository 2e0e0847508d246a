"""Plates with sections of any convex outline before objects: gaps, derivatives, a rim and a flush face."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rom import Plane, Rod, TouchedSegment
from rom.rod.compiled import loads
from rom.rod.compiled.contacts import Contacts, find_contacts
from tests.rom.rod.outlined import OUTLINES, gaps, obstacles, rod_of
from tests.rom.rod.plates import bare

SAMPLED = 2e-6  # what sampling is off [m]
STEP = 1e-7  # of an object [m]
FLAT = 1e-3  # relative, by the dome that straight sides count with [-]


def contacts_of(model: TouchedSegment, point: np.ndarray, moved: np.ndarray) -> Contacts:
    found = find_contacts(
        model.touching, point[:-1], float(point[-1]), moved, loads(model.rod.struct, np.zeros((1, 6)))
    )
    assert found is not None
    return found


def prism(rod: Rod) -> np.ndarray:
    """Points of the plate's side and front face, seen from its centre, shape (n, 3) [m]."""
    outline, half = rod.segments[0].section, rod.half_lengths[0]
    around = outline.points(720)
    if outline.radius == 0:
        around = np.concatenate([around, outline.vertices])
    x = np.linspace(-half, half, 41)
    side = np.column_stack([np.repeat(x, len(around)), np.tile(around, (len(x), 1))])
    face = np.concatenate([share * around for share in np.linspace(0, 1, 121)])
    return np.concatenate([side, np.insert(face, 0, half, axis=1)])


def before_plates(name: str, count: int, seed: int):
    """Objects that touch the plate first, from beside and before it, and a point a little away from that."""
    rod, random = bare(rod_of(name)), np.random.default_rng(seed)
    for k in range(count):
        tensions = random.uniform(5, 70, 2)
        plate = rod.place(tensions)
        centre, rotation = plate.centres[-1], plate.rotations[-1]
        out = rotation @ (random.standard_normal(3) * [1.0 if k % 2 else 0.1, 1.0, 1.0] + [k % 3, 0.0, 0.0])
        out /= np.linalg.norm(out)
        off = rotation @ (2e-3 * random.standard_normal(3))
        for obstacle in obstacles(centre + 0.002 * out + off, out, random):
            model = TouchedSegment(rod=rod, obstacle=obstacle)
            touch = float(model.outputs([[*tensions, np.inf]])[0, 4])
            if np.isfinite(touch):
                yield model, np.array([*tensions, touch]), centre, rotation


@pytest.mark.parametrize("name", OUTLINES)
def test_gaps_are_those_of_a_sampled_prism(name):
    points, random, compared = prism(rod_of(name)), np.random.default_rng(1), 0
    for model, point, centre, rotation in before_plates(name, 9, 2):
        d = point[-1] + random.uniform(0, 5e-4)
        gap = contacts_of(model, np.append(point[:-1], d), np.zeros(3)).gaps.min()
        sampled = gaps(model.obstacle, d, centre + points @ rotation.T).min()
        compared += 1
        assert -SAMPLED < gap - sampled < 1e-10
    assert compared > 25


@pytest.mark.parametrize("name", ["circle", "rounded square", "hexagon"])
def test_wrenches_change_as_objects_move(name):
    """A plate that moves by v before an object is an object that moves by -v."""
    compared, names = 0, set()
    for model, point, _, rotation in before_plates(name, 9, 3):
        here = contacts_of(model, point, np.zeros(3))
        for axis in range(3):
            moved = [contacts_of(model, point, sign * STEP * rotation[:, axis]) for sign in (-1, 1)]
            for k, label in enumerate(here.labels):
                if here.gaps[k] > 1e-4 or any(label not in one.labels for one in moved):
                    continue
                rows, (ahead, behind) = here.on[k][:6], [one.arms[:, 3 * one.labels.index(label)] for one in moved]
                differences, changes = (ahead - behind)[rows] / (2 * STEP), here.changes[k][0][:6, axis]
                assert changes == pytest.approx(differences, abs=FLAT * max(1.0, float(np.abs(differences).max())))
                compared += 1
                names.add(label[1])
    assert compared > 50
    assert min(names) < -2 and max(names) > -5  # points that stay, and points that slide


def test_a_disc_that_tips_over_its_rim_onto_its_face_is_pressed_without_a_jump():
    """The touch distance is that of the disc's support; of a jump of the force, steps half as long would be as high."""
    rod, steps = bare(rod_of("circle")), []
    plate = rod.place(np.zeros(2))
    centre, rotation, (thick, half, _) = plate.centres[-1], plate.rotations[-1], rod.half_lengths
    for count in (60, 120):
        forces = []
        for tilt in np.append(np.geomspace(1.0, 1e-5, count), 0.0):
            out, along = Rotation.from_rotvec([0.0, 0.3, 0.0]).apply(
                [[np.cos(tilt), np.sin(tilt), 0.0], [1.0, 0.5, 0.0]]
            )
            where = {"centre": tuple(centre), "direction": tuple(rotation @ along), "distances": (-0.1, 0.1)}
            model = TouchedSegment(rod=rod, obstacle=Plane(normal=tuple(-rotation @ out), **where))
            touch = float(model.outputs([[0.0, 0.0, np.inf]])[0, 4])
            support = thick * abs(out[0]) + half * np.hypot(*out[1:])  # of a disc [m]
            assert touch == pytest.approx(support * np.linalg.norm(along) / (out @ along), abs=1e-9)
            answer = model.answers([0.0, 0.0, touch - 2e-5])
            assert answer.inside[0]
            forces.append(float(answer.out[0, 3]))
        assert min(forces) > 0
        steps.append(np.abs(np.diff(forces)).max())
    assert steps[1] < 0.7 * steps[0]


@pytest.mark.parametrize("name", OUTLINES)
def test_a_flush_face_presses_as_that_of_a_square_does(name):
    """A rigid face that stays flush carries the same force and moment wherever its points are."""
    totals = []
    for rod in (bare(TouchedSegment.load().rod), bare(rod_of(name))):
        front = rod.place(np.zeros(2)).centres[-1] + [rod.half_lengths[0], 0.0, 0.0]
        plane = Plane(centre=tuple(front), normal=(-1.0, 0.0, 0.0), direction=(1.0, 0.0, 0.0), distances=(-0.1, 0.1))
        contacts = TouchedSegment(rod=rod, obstacle=plane).contact_forces(np.array([0.0, 0.0, -1e-5]))
        moment = sum(np.cross(one.place - front, one.force) for one in contacts)
        totals.append(np.append(sum(one.force for one in contacts), moment / rod.half_lengths[1]))
    assert totals[0][0] < -0.1
    assert totals[1] == pytest.approx(totals[0], abs=1e-4 * abs(totals[0][0]))
