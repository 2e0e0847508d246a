"""The effect of a stiffer neighbour on an element: its limits, and both ends of the element as mirror images."""

from dataclasses import replace

import numpy as np
import pytest

import rom
from rom.elements import rotation_vectors
from rom.elements.elements import CLAMP, INTERIOR
from rom.elements.pieces import Piece, cut
from rom.elements.transition import hindered_share, with_transitions
from rom.files.checked_file import ModelError

ELEMENTS = rom.load().rod.elements
LENGTH = ELEMENTS.laws[CLAMP].lengths[0]


def element(distal: float, proximal: float):
    piece = Piece(INTERIOR, LENGTH, hindered=(distal, proximal))
    return with_transitions(ELEMENTS.laws[INTERIOR].of_length(LENGTH), piece, ELEMENTS.laws)


def test_no_share_where_the_neighbour_is_as_stiff_or_softer_and_all_where_it_is_rigid():
    assert hindered_share(1.0, 1.0) == hindered_share(2.0, 1.0) == 0.0
    assert hindered_share(1.0, 1e9) == pytest.approx(1.0)
    shares = [hindered_share(1.0, ratio) for ratio in (1.0, 2.0, 4.0, 10.0, 100.0)]
    assert shares == sorted(shares) and shares[1] == pytest.approx(1 / 6)


def test_an_element_whose_proximal_neighbour_is_rigid_is_the_clamp_piece():
    found, clamp = element(0.0, 1.0), ELEMENTS.laws[CLAMP].of_length(LENGTH)
    box = found.polynomial
    points = np.random.default_rng(0).uniform(box.lower, box.upper, (20, len(box.lower)))
    assert box.value(points) == pytest.approx(clamp.polynomial.value(points), abs=1e-12)
    assert found.deviations is not None and (found.deviations.lower == box.lower).all()


def test_both_ends_are_mirror_images_under_a_moment():
    """Seen from the other end and in a mirror across the axis, an element bends alike."""
    for plane in (-2, -1):
        inputs = np.zeros((1, ELEMENTS.tensions + 6))
        inputs[0, plane] = 0.1 * ELEMENTS.laws[INTERIOR].polynomial.upper[-3:].max()
        plain, proximal, distal = (element(*one).value(inputs)[0, :6] for one in ((0, 0), (0, 1), (1, 0)))
        wanted, effect = mirrored(proximal) - mirrored(plain), distal - plain
        bent = [0, 1, 2, 4, 5]  # no twist, which is noise of the fit here
        assert np.abs(wanted[bent]).max() > 5e-4
        assert effect[bent] == pytest.approx(wanted[bent], abs=0.02 * np.abs(wanted).max())


def mirrored(pose: np.ndarray) -> np.ndarray:
    """The pose of an element seen from its other section, x and the turns about y and z in a mirror across x."""
    turned = rotation_vectors.matrices(pose[None, 3:])[0]
    seen, back = -turned.T @ pose[:3], rotation_vectors.vectors(turned.T[None])[0]
    return np.concatenate([seen * [-1, 1, 1], back * [1, -1, -1]])


def test_the_parts_of_an_element_have_the_effect_at_its_ends_alone():
    whole = Piece(INTERIOR, LENGTH, hindered=(0.2, 0.7))
    assert [one.hindered for one in cut([whole], 3)] == [(0.2, 0.0), (0.0, 0.0), (0.0, 0.7)]


def test_elements_without_an_interior_one_have_no_transition():
    laws = {CLAMP: ELEMENTS.laws[CLAMP]}
    piece = Piece(CLAMP, LENGTH, hindered=(0.5, 0.0))
    with pytest.raises(ModelError, match="materials along a part need an interior element, got none"):
        with_transitions(laws[CLAMP].of_length(LENGTH), piece, laws)
    shorter = replace(ELEMENTS.laws[INTERIOR], lengths=(0.005, 0.008))
    with pytest.raises(ModelError, match=r"need interior elements as long as the clamp piece, 0.010\d* m, got at"):
        with_transitions(laws[CLAMP].of_length(LENGTH), piece, laws | {INTERIOR: shorter})
