"""The rubber of sections with any convex outline before objects: gaps, balance, derivatives and continuity."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rom import Plane, TouchedSegment
from tests.rom.rod.outlined import OUTLINES, flat_rod, obstacles, rod_of, sampled_gap
from tests.rom.rod.test_rubber_contact import load_wrenches, pressed

# What sampling is off; and, of a polygon of short sides, that its corners are compared slice by slice [m].
SAMPLED, CORNERS = 3e-9, 1e-6
FREE = 0.021  # from the clamp on, loads are of sections alone [m]


@pytest.mark.parametrize("name", OUTLINES)
def test_gaps_are_those_of_a_dense_sampling_of_the_surface(name):
    rod, random = rod_of(name), np.random.default_rng(0)
    for _ in range(3):
        tensions, wrench = random.uniform(0, 70, 2), random.uniform(-1, 1, (1, 6)) * [2, 2, 2, 0.02, 0.02, 0.02]
        found = rod.sections(tensions, at=[random.uniform(0.4, 0.9) * rod.rest[0]])
        out = found.rotations[0] @ [0.2 * random.standard_normal(), *random.standard_normal(2)]
        out /= np.linalg.norm(out)
        for obstacle in obstacles(found.centres[0] + rod.half_lengths[1] * out, out, random)[:3]:
            d = random.uniform(-0.002, 0.002)
            gap = TouchedSegment(rod=rod, obstacle=obstacle).rubber_gap(np.array([*tensions, d]), wrench)
            sampled = sampled_gap(rod, tensions, wrench, obstacle, d)
            assert -SAMPLED < gap - sampled < (CORNERS if name == "64 corners" else 1e-10)


def test_gaps_of_a_rectangle_are_those_of_its_edges_and_faces():
    """Without tension, which raises ridges over tendons."""
    rod, random, compared = flat_rod(), np.random.default_rng(6), 0
    for _ in range(6):
        wrench = random.uniform(-1, 1, (1, 6)) * [2, 2, 2, 0.03, 0.03, 0.03]
        found = rod.sections(np.zeros(2), at=[random.uniform(0.4, 0.9) * rod.rest[0]])
        out = found.rotations[0] @ [0.1 * random.standard_normal(), *random.standard_normal(2)]
        out /= np.linalg.norm(out)
        for obstacle in obstacles(found.centres[0] + rod.half_lengths[1] * out, out, random)[:3]:
            gap = TouchedSegment(rod=rod, obstacle=obstacle).rubber_gap(np.zeros(3), wrench)
            compared += 1
            assert gap == pytest.approx(sampled_gap(rod, np.zeros(2), wrench, obstacle, 0.0), abs=3e-8)
    assert compared == 18


@pytest.mark.parametrize("name", ["circle", "rounded square"])
@pytest.mark.parametrize("shape", ["plane", "sphere", "cylinder", "box"])
def test_loads_are_in_balance_and_derivatives_are_those_of_the_answers(name, shape):
    """But for how the surface changes its shape under the load, which the solve counts and the derivative does not."""
    rod, random, errors, balanced = rod_of(name), np.random.default_rng(3), [], 0
    for _ in range(6):
        model, point = pressed(rod, random, shape)
        contacts, answer = model.contact_forces(point), model.answers(point)
        force = sum(one.force for one in contacts)
        assert all(one.rubber for one in contacts)
        assert -force @ model.direction == pytest.approx(answer.out[0, 3], rel=1e-5)
        if min(np.linalg.norm(one.place) for one in contacts) > FREE:  # else a part goes to the ground
            balanced += 1
            moment, found = sum(np.cross(one.place, one.force) for one in contacts), load_wrenches(model, point)
            assert found[:3] == pytest.approx(force, abs=1e-4 * np.linalg.norm(force))
            assert found[3:] == pytest.approx(moment, abs=1e-4 * np.linalg.norm(force) * 0.05)
        ahead, behind = model.outputs(point + np.outer([1, -1], [0.0, 0.0, 1e-6]))
        slopes, differences = model.jacobian(point)[:, -1], (ahead - behind) / 2e-6
        errors.append(abs(slopes[3] - differences[3]) / abs(differences[3]))
        assert slopes[:3] == pytest.approx(differences[:3], abs=0.1 * np.linalg.norm(differences[:3]))
    assert balanced > 0
    assert np.median(errors) < 0.02 and max(errors) < 0.1


@pytest.mark.parametrize("shape", ["plane", "sphere"])
def test_the_force_on_a_circle_has_no_jump_as_the_object_approaches(shape):
    rod, random = rod_of("circle"), np.random.default_rng(4)
    for _ in range(2):
        model, point = pressed(rod, random, shape)
        touch = float(model.outputs(point[None])[0, 4])
        steepest = []
        for count in (30, 200):  # of a jump, shorter steps would be steeper
            depths = np.array([0.0, 1e-9, 1e-7, *np.linspace(1e-6, touch - point[-1], count)])
            rows = np.column_stack([np.tile(point[:-1], (len(depths), 1)), touch - depths])
            answers = model.answers(rows)
            forces = answers.out[:, 3]
            assert forces[0] == 0.0 and forces[1] < 1e-4 and (answers.evaluations > 0).all()
            assert (np.diff(forces) > -1e-9).all()
            steepest.append(np.max(np.diff(forces[2:]) / np.diff(depths[2:])))
        assert steepest[1] < 1.5 * steepest[0]


def test_a_plane_that_rolls_around_a_circle_presses_it_steadily():
    """The straight finger yields nearly alike in all directions, as the law of its square does."""
    rod, forces, angles = rod_of("circle"), [], np.linspace(0.0, np.pi / 2, 46)
    middle = rod.sections(np.zeros(2), at=[0.03]).centres[0]
    for angle in angles:
        out = Rotation.from_rotvec([angle, 0.0, 0.0]).apply([0.0, 1.0, 0.0])
        where = {"direction": tuple(out), "distances": (-0.01, 0.01)}
        tilted = Rotation.from_rotvec(0.15 * np.cross(out, [1.0, 0.0, 0.0])).apply(-out)
        plane = Plane(centre=tuple(middle + rod.half_lengths[1] * out), normal=tuple(tilted), **where)
        model = TouchedSegment(rod=rod, obstacle=plane)
        touch = float(model.outputs([[0.0, 0.0, np.inf]])[0, 4])
        answer = model.answers([0.0, 0.0, touch - 5e-4])
        assert answer.inside[0]
        forces.append(float(answer.out[0, 3]))
    assert np.ptp(forces) < 0.05 * np.mean(forces)
    assert np.abs(np.diff(forces)).max() < 0.01 * np.mean(forces)
    assert forces[0] == pytest.approx(forces[-1], rel=5e-3)  # about z as about y
