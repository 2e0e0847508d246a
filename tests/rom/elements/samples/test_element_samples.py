"""Samples of elements: equal to the rod's own, with derivatives by what the element itself transmits."""

from dataclasses import replace

import numpy as np
import pytest

from rom.elements import rotation_vectors
from rom.elements.samples.element_samples import element_samples
from rom.elements.samples.section_states import Bodies
from tests.rom.elements import elastic_rod
from tests.rom.elements.images import image

PAIRS = {"clamp piece": (0, 10), "interior element": (15, 23), "plate piece": (39, 50), "whole": (0, 50)}


@pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS)
def test_an_element_alone_under_its_wrench_is_what_it_was_in_the_finger(rod_states, pair):
    """A rod of the element's length, whose plate is the distal section, bends as the element does."""
    samples = element_samples(rod_states, *pair)
    ahead = elastic_rod.PLATE / 2 if pair[1] == 50 else 0.0
    length = samples.length + elastic_rod.PLATE - ahead
    at_face = samples.inputs.copy()
    if not ahead:  # the wrench is about the section's centre, the rod's is about its plate's
        at_face[:, 5:] -= np.cross([elastic_rod.PLATE / 2, 0, 0], at_face[:, 2:5])
    seen = elastic_rod.seen_from_plate(at_face, length)
    place = seen.places[-1] + [0.0 if ahead else elastic_rod.PLATE / 2, 0, 0]
    np.testing.assert_allclose(samples.values[:, :3], place, atol=1e-11)
    np.testing.assert_allclose(rotation_vectors.matrices(samples.values[:, 3:6]), seen.rotations[-1], atol=1e-9)
    np.testing.assert_allclose(samples.values[:, 6:], seen.shortenings[-1], atol=1e-11)


@pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS)
def test_derivatives_are_by_tensions_and_by_the_wrench_that_the_element_transmits(rod_states, pair):
    """Two states that differ little: the change of the pose is the mean derivative times the change of the inputs."""
    samples, random = element_samples(rod_states, *pair), np.random.default_rng(1)
    ahead = elastic_rod.PLATE / 2 if pair[1] == 50 else 0.0
    arm = np.array([elastic_rod.PLATE / 2 - ahead, 0, 0])
    length = samples.length + elastic_rod.PLATE - ahead

    def pose(inputs: np.ndarray) -> np.ndarray:
        at_face = inputs.copy()
        at_face[:, 5:] -= np.cross(arm, at_face[:, 2:5])
        seen = elastic_rod.seen_from_plate(at_face, length)
        vectors = rotation_vectors.vectors(seen.rotations[-1])
        return np.concatenate([seen.places[-1] + arm, vectors, seen.shortenings[-1]], axis=1)

    direction = random.uniform(-1, 1, samples.inputs.shape) * np.repeat([1e-2, 1e-3, 1e-5], [2, 3, 3])
    change = (pose(samples.inputs + direction) - pose(samples.inputs - direction)) / 2
    wanted = np.einsum("nvp,np->nv", samples.jacobians, direction)
    np.testing.assert_allclose(wanted, change, atol=1e-6 * np.abs(change).max())


def test_a_rigid_motion_of_the_finger_changes_no_sample(rod_states):
    turned = rotation_vectors.matrices(np.array([[0.3, -0.2, 0.5]]))[0]

    def moved(bodies: Bodies) -> Bodies:
        return replace(bodies, places=bodies.places @ turned.T + [1, 2, 3], rotations=turned @ bodies.rotations)

    elsewhere = replace(rod_states, sections=moved(rod_states.sections), plate=moved(rod_states.plate))
    for pair in PAIRS.values():
        one, other = element_samples(rod_states, *pair), element_samples(elsewhere, *pair)
        np.testing.assert_allclose(one.inputs, other.inputs, atol=1e-13)
        np.testing.assert_allclose(one.values, other.values, atol=1e-13)
        np.testing.assert_allclose(one.jacobians, other.jacobians, atol=1e-11)


@pytest.mark.parametrize("offsets, count", [(elastic_rod.TWO, 1), (elastic_rod.FOUR, 7)], ids=["two", "four"])
def test_the_image_of_a_sample_is_the_sample_of_the_mirrored_finger(offsets, count):
    """Two tendons are symmetric about y = z, four about all axes of the square: an image is another of their states."""
    states = elastic_rod.states(2, 3, offsets=offsets)
    samples, found = element_samples(states, 20, 28), states.mirrors
    assert len(found) == count
    arm, t = np.array([elastic_rod.PLATE / 2, 0, 0]), len(offsets)
    for mirror in found:
        mirrored = image(mirror, samples)
        np.testing.assert_array_equal(np.sort(mirrored.inputs[:, :t]), np.sort(states.inputs[:, :t]))
        at_face = mirrored.inputs.copy()
        at_face[:, t + 3 :] -= np.cross(arm, at_face[:, t : t + 3])
        seen = elastic_rod.seen_from_plate(at_face, samples.length + elastic_rod.PLATE, offsets)
        np.testing.assert_allclose(mirrored.values[:, :3], seen.places[-1] + arm, atol=1e-11)
        np.testing.assert_allclose(rotation_vectors.matrices(mirrored.values[:, 3:6]), seen.rotations[-1], atol=1e-9)
        np.testing.assert_allclose(mirrored.values[:, 6:], seen.shortenings[-1], atol=1e-11)
