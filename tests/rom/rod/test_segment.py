"""A segment of the bundled finger: moduli of its rubber in closed form, its motion, and other sizes of it."""

from dataclasses import replace

import numpy as np
import pytest

from rom import TouchedSegment
from rom.elements.pieces import Piece
from rom.files.checked_file import ModelError
from rom.rod.segment import UNDER, segment_of

PULLED = np.array([30.0, 12.0, 0.4, -0.5, 0.3, 0.01, -0.02, 0.015])  # tensions and a wrench


def at_size(rod, size: float, modulus: float = 1.0):
    """The bundled finger's segment, larger and of stiffer rubber."""
    pieces = [piece._replace(length=size * piece.length) for piece in rod.pieces[0]]
    return segment_of(rod.elements.scaled(size, modulus), pieces, rod.names, rod.segments[0].trained)


@pytest.mark.parametrize("name", ["finger", "round", "square"])
def test_moduli_at_small_strain_are_those_of_the_law(name):
    """C1 = mu / 2 and D1 = 2 / K. Plates make the rubber next to them up to 11 % stiffer."""
    rod = TouchedSegment.load(name).rod
    tendons = [one | {"tension": [0.0, 5.0]} for one in rod.scene["tendons"]]
    geometry = rod.scene["geometry"] | {"taper": [0.8]}
    cone = rod.assembled(rod.scene | {"geometry": geometry, "tendons": tendons})
    material, segment = rod.scene["material"], rod.segments[0]
    assert cone.segments[0].young_modulus == pytest.approx(segment.young_modulus, rel=0.01)
    mu, bulk = 2 * material["C1"], 2 / material["D1"]
    assert segment.young_modulus == pytest.approx(9 * bulk * mu / (3 * bulk + mu), rel=0.005)
    assert segment.poisson == pytest.approx((3 * bulk - 2 * mu) / (2 * (3 * bulk + mu)), abs=0.01)


@pytest.mark.parametrize(("size", "modulus"), [(3.0, 1.0), (0.5, 4.0)])
def test_a_similar_segment_has_the_same_turns_and_scaled_places(rod, size, modulus):
    segment, other, force = rod.segments[0], at_size(rod, size, modulus), modulus * size**2
    assert other.young_modulus == pytest.approx(modulus * segment.young_modulus, rel=1e-6)
    assert other.poisson == pytest.approx(segment.poisson, rel=1e-6)
    assert other.rest == pytest.approx(size * segment.rest) and other.offsets == pytest.approx(size * segment.offsets)
    units = np.array([force] * 5 + [force * size] * 3)
    centre, rotation, _, inside = segment.place(PULLED)
    larger, turned, _, also = other.place(units * PULLED)
    assert larger == pytest.approx(size * centre, rel=1e-6) and turned == pytest.approx(rotation, abs=1e-8)
    assert inside and also


def test_only_a_tendon_near_a_face_raises_a_ridge_on_it(rod):
    segment = rod.segments[0]
    half = segment.half_lengths[1]
    offsets = half * np.array([[1 - 0.9 * UNDER, 0.0], [-1 + 1.1 * UNDER, -1 + 0.5 * UNDER]])
    ridges = replace(segment, offsets=offsets).condensed.ridges
    assert ridges * segment.young_modulus == pytest.approx(np.array([[1.0, 0.0], [0.0, -1.0]]))


def test_pieces_in_series_are_as_long_as_their_sum_and_wrong_inputs_are_refused(rod):
    pieces = rod.pieces[0]
    longer = segment_of(rod.elements, [pieces[0], *pieces[1:-1] * 2, pieces[-1]], rod.names, [0, 1])
    assert longer.length == pytest.approx(2 * rod.segments[0].length - pieces[0].length - pieces[-1].length)
    centre, rotation, _, _ = longer.place(np.zeros(8))
    assert centre == pytest.approx(longer.rest, abs=2e-5) and rotation == pytest.approx(np.eye(3), abs=1e-3)
    assert isinstance(pieces[0], Piece) and longer.elements[1] is longer.elements[2]
    with pytest.raises(ModelError, match=r"inputs must be F1, F2 and a wrench, got shape \(7,\)"):
        longer.place(np.zeros(7))
