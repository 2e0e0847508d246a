import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rom import TouchedSegment
from tests.rom.rod.inverse import inverse, spring


@pytest.fixture(scope="module")
def segment():
    return TouchedSegment.load().rod.segments[0]


def seen(placed):
    """Centre and quaternion, w first."""
    centre, rotation, _, _ = placed
    return centre, Rotation.from_matrix(rotation).as_quat()[[3, 0, 1, 2]]


def random_inputs(segment, random, force):
    tensions = random.uniform(0, 60, 2)
    pressed = random.standard_normal(3)
    pressed *= force * random.random() / np.linalg.norm(pressed)
    at = random.uniform(-1, 1, 3) * segment.half_lengths
    return np.concatenate([tensions, pressed, np.cross(at, pressed)])


def test_it_finds_the_wrench_that_made_a_pose(segment):
    random = np.random.default_rng(22)
    for _ in range(200):
        inputs = random_inputs(segment, random, 2.0)
        placed = segment.place(inputs)
        found = inverse(segment.struct, inputs[:2], *seen(placed))
        assert found.evaluations > 0 and found.inside
        np.testing.assert_allclose(found.wrench, inputs[2:], atol=1e-7)
        np.testing.assert_allclose(found.stiffness @ placed[2][:, 2:], np.eye(6), atol=1e-4)


def test_from_pose_to_pose_it_takes_few_evaluations(segment):
    wrench, most = np.zeros(6), 0
    for share in np.linspace(0, 1, 50):
        inputs = np.array([40 * share, 10 * share, -share, -2 * share, 0.5 * share, 0, 0, 0])
        found = inverse(segment.struct, inputs[:2], *seen(segment.place(inputs)), wrench)
        wrench, most = found.wrench, max(most, found.evaluations)
        assert found.evaluations > 0
        np.testing.assert_allclose(wrench, inputs[2:], atol=1e-7)
    assert most <= 4


def as_spring(segment, rotation, wrench, stiffness):
    """The same by NumPy: the force turns with the plate, and negative eigenvalues become 0."""
    own, f = stiffness.copy(), wrench[:3]
    own[:3, 3:] -= [[0, -f[2], f[1]], [f[2], 0, -f[0]], [-f[1], f[0], 0]]
    turn, sizes = np.eye(6), np.repeat([1.0, segment.half_lengths[1]], 3)
    turn[:3, :3] = rotation
    seen = turn @ own @ turn.T
    values, vectors = np.linalg.eigh((seen + seen.T) / 2 / np.outer(sizes, sizes))
    kept = (vectors * np.maximum(values, 0)) @ vectors.T * np.outer(sizes, sizes)
    return np.append(rotation @ f, wrench[3:]), kept, values.min()


def test_as_a_spring_it_never_pushes_a_plate_away(segment):
    """Forces of 12 N along the finger would let it buckle."""
    random, least = np.random.default_rng(25), []
    for _ in range(100):
        inputs = random_inputs(segment, random, 12.0)
        placed = segment.place(inputs)
        centre, quaternion = seen(placed)
        own = inverse(segment.struct, inputs[:2], centre, quaternion)
        force, stiffness, lowest = as_spring(segment, placed[1], own.wrench, own.stiffness)
        found = spring(segment.struct, quaternion, own)
        np.testing.assert_allclose(found[0], force, atol=1e-9)
        np.testing.assert_allclose(found[1], stiffness, atol=1e-9 * np.abs(stiffness).max())
        least.append(lowest)
    assert min(least) < 0 < max(least)


def test_a_spring_s_stiffness_is_the_change_of_its_force(segment):
    """Its symmetric part, turns counted as ways of the plate's corner."""
    random, step, slopes = np.random.default_rng(26), 1e-6, np.zeros((6, 6))
    inputs, sizes = random_inputs(segment, random, 1.0), np.repeat([1.0, segment.half_lengths[1]], 3)
    centre, quaternion = seen(segment.place(inputs))
    own = inverse(segment.struct, inputs[:2], centre, quaternion)
    for k in range(6):
        for sign in (-1, 1):
            change = np.zeros(6)
            change[k] = sign * step / sizes[k]
            turned = Rotation.from_quat(quaternion[[1, 2, 3, 0]]) * Rotation.from_rotvec(change[3:])
            there = turned.as_quat()[[3, 0, 1, 2]]
            moved = inverse(segment.struct, inputs[:2], centre + change[:3], there, own.wrench)
            slopes[:, k] += sign * spring(segment.struct, there, moved)[0] / sizes / (2 * step)
    stiffness, expected = spring(segment.struct, quaternion, own)[1], (slopes + slopes.T) / 2
    np.testing.assert_allclose(stiffness / np.outer(sizes, sizes), expected, atol=1e-5 * np.abs(expected).max())


def test_what_has_no_wrench_says_so_in_finite_numbers(segment):
    random = np.random.default_rng(24)
    for k in range(300):
        centre = random.standard_normal(3) if k % 3 else np.full(3, np.nan)
        found = inverse(segment.struct, [np.nan if k % 2 else 30.0, 20.0], centre, random.standard_normal(4) * (k % 5))
        assert np.isfinite(found.wrench).all() and np.isfinite(found.stiffness).all()
        assert not (found.evaluations > 0 and found.inside)
