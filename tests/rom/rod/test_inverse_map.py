import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rom import TouchedSegment
from rom.rod.inverse_map import InverseMap


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
    random, inverse = np.random.default_rng(22), InverseMap(segment)
    for _ in range(200):
        inputs = random_inputs(segment, random, 2.0)
        inverse.forget()
        inverse.find(inputs[:2], *seen(segment.place(inputs)))
        assert inverse.converged and inverse.inside
        np.testing.assert_allclose(inverse.wrench, inputs[2:], atol=1e-7)


def test_its_stiffness_is_that_of_the_segment(segment):
    random, inverse = np.random.default_rng(23), InverseMap(segment)
    inputs = random_inputs(segment, random, 2.0)
    placed = segment.place(inputs)
    inverse.find(inputs[:2], *seen(placed))
    np.testing.assert_allclose(inverse.stiffness @ placed[2][:, 2:], np.eye(6), atol=1e-6)


def test_from_pose_to_pose_it_takes_few_evaluations(segment):
    inverse, most = InverseMap(segment), 0
    for share in np.linspace(0, 1, 50):
        inputs = np.array([40 * share, 10 * share, -share, -2 * share, 0.5 * share, 0, 0, 0])
        most = max(most, inverse.find(inputs[:2], *seen(segment.place(inputs))))
        np.testing.assert_allclose(inverse.wrench, inputs[2:], atol=1e-7)
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
    random, inverse, least = np.random.default_rng(25), InverseMap(segment), []
    for _ in range(100):
        inputs = random_inputs(segment, random, 12.0)
        placed = segment.place(inputs)
        inverse.forget()
        inverse.find(inputs[:2], *seen(placed))
        force, stiffness, lowest = as_spring(segment, placed[1], inverse.wrench, inverse.stiffness)
        found = inverse.spring()
        np.testing.assert_allclose(found[0], force, atol=1e-9)
        np.testing.assert_allclose(found[1], stiffness, atol=1e-9 * np.abs(stiffness).max())
        least.append(lowest)
    assert min(least) < 0 < max(least)


def test_a_spring_s_stiffness_is_the_change_of_its_force(segment):
    """Its symmetric part, turns counted as ways of the plate's corner."""
    random, inverse, step = np.random.default_rng(26), InverseMap(segment), 1e-6
    inputs, sizes = random_inputs(segment, random, 1.0), np.repeat([1.0, segment.half_lengths[1]], 3)
    centre, quaternion = seen(segment.place(inputs))
    inverse.find(inputs[:2], centre, quaternion)
    stiffness, slopes = inverse.spring()[1], np.zeros((6, 6))
    for k in range(6):
        for sign in (-1, 1):
            change = np.zeros(6)
            change[k] = sign * step / sizes[k]
            turned = Rotation.from_quat(quaternion[[1, 2, 3, 0]]) * Rotation.from_rotvec(change[3:])
            inverse.find(inputs[:2], centre + change[:3], turned.as_quat()[[3, 0, 1, 2]])
            slopes[:, k] += sign * inverse.spring()[0] / sizes / (2 * step)
    expected = (slopes + slopes.T) / 2
    np.testing.assert_allclose(stiffness / np.outer(sizes, sizes), expected, atol=1e-5 * np.abs(expected).max())


def test_what_has_no_wrench_says_so_in_finite_numbers(segment):
    random, inverse = np.random.default_rng(24), InverseMap(segment)
    for k in range(300):
        centre = random.standard_normal(3) if k % 3 else np.full(3, np.nan)
        inverse.find([np.nan if k % 2 else 30.0, 20.0], centre, random.standard_normal(4) * (k % 5))
        assert np.isfinite(inverse.wrench).all() and np.isfinite(inverse.stiffness).all()
        assert not (inverse.converged and inverse.inside)
