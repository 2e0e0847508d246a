"""The outline of elements: corners of an elastic rod's cross-sections, which stay squares."""

from dataclasses import replace

import numpy as np
import pytest

from rom.elements.fitting.prepared import fold_of
from rom.elements.outline import CORNERS, outline_samples, train_outline
from rom.elements.samples.cuts import outline_pairs
from tests.rom.elements import elastic_rod

HALF = elastic_rod.SIDE / 2


@pytest.mark.parametrize("kind, distal, distances", [("interior", 25, [0, 4, 9]), ("plate", 50, [0, 5, 10])])
def test_corners_are_those_of_a_square_on_the_rod(rod_states, rod_elements, kind, distal, distances):
    law, held_out = rod_elements.outlines[kind], elastic_rod.states(6, 11)
    inputs = held_out.inputs[:, :2], held_out.transmitted(distal)[0]
    distal_body = held_out.body(distal)
    for steps in distances:
        section = min(distal, 49) - steps
        near = held_out.sections[section]
        places = near.places[:, None] + np.einsum("nij,kj->nki", near.rotations, np.c_[np.zeros(4), HALF * CORNERS])
        seen = np.einsum("nji,nkj->nki", distal_body.rotations, places - distal_body.places[:, None])
        ahead = elastic_rod.PLATE / 2 if distal == 50 else 0.0
        found = law.corners(np.concatenate(inputs, axis=1), steps * elastic_rod.STEP + ahead)
        off = np.linalg.norm(found - seen, axis=2)
        assert np.quantile(off, 0.95) < 3 * law.error and law.error < 5e-6
        at = law.at(steps * elastic_rod.STEP + ahead).value(np.concatenate(inputs, axis=1))
        np.testing.assert_allclose(at.reshape(found.shape), found, atol=1e-14)


def test_derivatives_are_by_what_the_distal_section_transmits(rod_states):
    """Two states along a line of inputs: the change of corners is the mean derivative times that of the inputs."""
    samples = outline_samples(rod_states, 20, 27)
    direction = np.random.default_rng(4).uniform(-1, 1, 8) * np.repeat([1e-2, 1e-3, 1e-5], [2, 3, 3])
    ends = []
    for sign in (1, -1):
        inputs = rod_states.inputs + sign * direction
        places, turned, _ = elastic_rod.in_space(inputs, 0.050)
        moved = replace(
            rod_states,
            inputs=inputs,
            sections=replace(rod_states.sections, places=places[:, :50], rotations=turned[:, :50]),
            plate=replace(rod_states.plate, places=places[:, 50], rotations=turned[:, 50]),
        )
        ends.append(outline_samples(moved, 20, 27))
    change = (ends[0].values - ends[1].values) / 2
    by_inputs = (ends[0].inputs - ends[1].inputs) / 2
    wanted = np.einsum("nvp,np->nv", samples.jacobians, by_inputs)
    np.testing.assert_allclose(wanted, change, atol=1e-6 * np.abs(change).max())


def test_the_outline_of_a_mirrored_finger_is_mirrored(rod_states, rod_elements):
    (mirror,) = rod_states.mirrors
    law, inputs = rod_elements.outlines["interior"], rod_states.transmitted(25)[0]
    own = np.concatenate([rod_states.inputs[:, :2], inputs], axis=1)
    image = law.corners(own @ mirror.inputs.T, 0.007)
    swapped = law.corners(own, 0.007)[:, [0, 2, 1, 3]][:, :, [0, 2, 1]]
    np.testing.assert_allclose(image, swapped, atol=1e-9)


def test_a_larger_stiffer_outline_is_similar(rod_elements):
    law, own = rod_elements.outlines["clamp"], elastic_rod.pressed(2, 8)
    factors = np.repeat([2.0 * 9, 2.0 * 9, 2.0 * 27], [2, 3, 3])
    other = law.scaled(3.0, 2.0)
    np.testing.assert_allclose(other.corners(own * factors, 0.015), 3 * law.corners(own, 0.005), atol=1e-13)
    assert other.error == 3 * law.error


def test_faces_next_to_a_plate_bulge_without_waves(rod_states):
    """Sections 2 mm apart grow by F1 + F2, but not at the plate, within 1.5 mm of which the growth fades out."""
    every, most, depth = slice(1, None, 2), 6e-4, 1.5e-3  # growth [1/N], depth [m]

    def grown(away):
        return most * (1 - np.exp(-away / depth))[..., None, None] * np.c_[np.zeros(4), HALF * CORNERS]

    at = rod_states.at[every]
    changes = np.zeros((len(rod_states.inputs), len(at), 4, 3, 8))
    changes[..., :2] = grown(at[-1] - at)[..., None]
    states = replace(
        rod_states,
        at=at,
        sections=rod_states.sections[every],
        corners=np.einsum("nmkip,np->nmki", changes, rod_states.inputs),
        corner_changes=changes,
        shortenings=rod_states.shortenings[:, every],
        shortening_changes=rod_states.shortening_changes[:, every],
    )
    law = train_outline(states, fold_of(states)[1], outline_pairs(at, elastic_rod.SIDE)["plate"])
    assert law.cross_sections == pytest.approx(elastic_rod.PLATE / 2 + 2e-3 * np.arange(6), rel=2e-6)
    inputs, distances = np.zeros((1, 8)), np.linspace(*law.distances, 41)
    inputs[0, 0] = elastic_rod.MOST_TENSION
    corners = np.array([law.corners(inputs, distance)[0] for distance in distances])
    sides = np.linalg.norm(corners[:, [1, 3, 2, 0]] - corners[:, [0, 1, 3, 2]], axis=2) - elastic_rod.SIDE
    largest = 2 * elastic_rod.MOST_TENSION * most * HALF
    off = np.abs(sides / largest - (1 - np.exp(-(distances - distances[0]) / depth))[:, None]).max(axis=1)
    assert off[::8].max() < 0.02 and off.max() < 0.15 and off[8:].max() < 0.05
