"""The rubber of sections with any convex outline before objects: gaps, and the same force all around a circle."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rom import Plane, TouchedSegment
from tests.rom.rod.outlined import OUTLINES, flat_rod, obstacles, rod_of, sampled_gap

# What sampling is off; and, of a polygon of short sides, that its corners are compared slice by slice [m].
SAMPLED, CORNERS = 3e-9, 1e-6


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
