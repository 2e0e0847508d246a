"""The surface of a finger of elements: corners of its cross-sections, as compiled code has them from outlines."""

from dataclasses import replace

import numpy as np
import pytest

from rom import TouchedSegment
from rom.elements.pieces import Piece
from rom.files.checked_file import ModelError
from rom.rod import compiled as native
from rom.rod.compiled.arrangement import places_between
from rom.rod.compiled.evaluation import sections
from rom.rod.compiled.outlines import knots_of, outline_of
from rom.rod.rod import Rod
from rom.rod.shape import displacements, placed
from tests.rom.elements import elastic_rod, laws
from tests.rom.elements.elastic_rod import PLATE, SQUARE, corners_at

NEAR = 3e-6  # how near the assembled surface is to the elastic rod's [m]


@pytest.fixture(scope="module")
def finger(rod_states, rod_elements) -> Rod:
    return Rod(elements=rod_elements, scene=rod_states.scene)


@pytest.mark.parametrize("length", [0.021, 0.033, 0.050, 0.080])
def test_drawn_sections_are_squares_on_the_rod(finger, length):
    """From the clamp to the plate's back, evenly; then its front."""
    own, inputs = finger.assembled(elastic_rod.scene(length)), elastic_rod.pressed(6, 3)
    inputs *= 0.5 * min(1.0, 0.050 / length)
    found = np.array([sections(own.struct, row[:2], row[2:])[0] for row in inputs])
    at = np.linspace(0.0, length - PLATE, found.shape[1] - 1)
    assert np.abs(found[:, :-1] - corners_at(inputs, length, at)).max() < NEAR
    for row, (back, front) in zip(inputs, found[:, -2:], strict=True):
        plate = own.place(row[:2], row[None, 2:])
        for corners, ahead in ((back, -PLATE / 2), (front, PLATE / 2)):
            expected = plate.centres[0] + (SQUARE + np.array([ahead, 0.0, 0.0])) @ plate.rotations[0].T
            assert corners == pytest.approx(expected, abs=1e-15)


def test_sections_of_two_segments_stand_one_on_the_other(finger):
    scene = elastic_rod.scene()
    scene["geometry"] = scene["geometry"] | {"segments": [0.040, 0.060]}
    both = finger.assembled(scene | {"tendons": [one | {"segment": 2} for one in scene["tendons"]]})
    tensions, wrenches = np.array([9.0, 14.0]), elastic_rod.pressed(1, 1)[2:4, 2:] / 4
    lower, upper = sections(both.struct, tensions, wrenches)
    assert upper[0] == pytest.approx(lower[-1], abs=1e-15)
    assert lower[0] == pytest.approx(SQUARE, abs=1e-15)


def test_compiled_corners_are_those_of_the_laws():
    """At the knots by the laws in NumPy, to the single precision of coefficients; between them by the weights.

    Beyond the trained wrenches too.
    """
    rod, random = TouchedSegment.load().rod, np.random.default_rng(2)
    (own,) = rod.segments
    knots = knots_of(own.outlines, rod.half_lengths[0])
    assert (np.diff(knots) > 0).all() and knots[[0, -1]] == pytest.approx([0.0, own.length - PLATE / 2])
    known = places_between(knots, np.array([one.length for one in own.outlines]))
    beyond = 0
    for share in np.repeat([1.0, 10.0], 10):
        tensions = 80 * random.random(2)
        wrench = share * random.uniform(-1, 1, (1, 6)) * np.repeat([2.0, 0.05], 3)
        beyond += not rod.place(tensions, wrench).inside
        at_rest = np.array([[x, *corner] for x in knots[1:-1] for corner in SQUARE[:, 1:]])
        inner = (at_rest + displacements(rod, placed(rod, tensions, wrench), at_rest)).reshape(-1, 4, 3)
        found = sections(rod.struct, tensions, wrench)[0]
        corners = np.concatenate([found[:1], inner, found[-2:-1]])
        near = corners[known["first"][:, None] + np.arange(known["near"])]
        assert found[:-1] == pytest.approx(np.einsum("pk,pkij->pij", known["between"], near), abs=2e-9)
    assert 3 < beyond < 17


def test_places_interpolate_cubics_exactly_wherever_the_knots_are():
    knots = np.sort(np.random.default_rng(0).random(9))
    known = places_between(knots, np.ptp(knots) * np.array([0.2, 0.5, 0.3]))
    places = np.linspace(knots[0], knots[-1], known["places"])
    values = (knots**3 - 2 * knots)[known["first"][:, None] + np.arange(known["near"])]
    assert (known["between"] * values).sum(axis=1) == pytest.approx(places**3 - 2 * places, abs=1e-12)


def test_every_slice_is_of_one_element_where_its_middle_is():
    knots, lengths = np.linspace(0.0, 0.9, 7), np.array([0.3, 0.2, 0.5])  # from the plate; the clamp is at 0
    known = places_between(knots, lengths)
    places = np.linspace(0.0, 0.9, known["places"])
    begins = np.array([1.0, 0.7, 0.5, 0.0])  # of the elements, and the clamp
    own, shares = known["place_elements"], known["place_shares"]
    middles = begins[own + 1] + shares * lengths[own]
    assert middles == pytest.approx((places[1:] + places[:-1]) / 2)
    assert (shares >= 0).all() and (shares <= 1).all() and set(own.tolist()) == {0, 1, 2}


def test_a_finger_of_another_size_is_noticed_as_early_by_its_size(finger):
    scene, size = elastic_rod.scene(), 3.0
    scene["geometry"] = {"side": size * 0.010, "segments": [size * 0.050], "plate": size * PLATE, "channel": None}
    scene["tendons"] = [one | {"offset": [size * part for part in one["offset"]]} for one in scene["tendons"]]
    larger = finger.assembled(scene)
    assert larger.errors.surface == pytest.approx(size * finger.errors.surface)
    errors = [law.error for law in finger.own.outlines.values()]
    assert finger.struct.surface_error == finger.errors.surface == max(errors) + finger.errors.position > 0
    inputs = 0.5 * elastic_rod.pressed(1, 4)[3]
    force = size**2
    one = sections(finger.struct, inputs[:2], inputs[2:])[0]
    other = sections(larger.struct, force * inputs[:2], force * inputs[2:] * np.repeat([1, size], 3))[0]
    assert other == pytest.approx(size * one, abs=1e-8)


def a_segment(outlines: list) -> native.CondensedSegment:
    """A rod of two elements of one law."""
    element = laws.law(2, 0, degree=1)
    return native.CondensedSegment(
        elements=laws.as_maps([element] * 2), half_lengths=np.array([0.0005, 0.005, 0.005]), outlines=outlines
    )


def an_outline(knots: int = 2, **changes) -> native.Outline:
    law, length = laws.law(2, 0, degree=1), laws.LENGTH
    polynomial = replace(law, coefficients=np.zeros((len(law.powers), 12 * knots)))
    distances = length * np.linspace(1, 0.1, knots + 1)[1:]
    return native.Outline(**{"polynomial": polynomial, "distances": distances, "length": length} | changes)


def test_an_outline_beyond_what_compiled_code_holds_is_refused_by_name_and_limit():
    one, own = an_outline(), an_outline().polynomial
    other_box = replace(own, upper=own.upper + np.eye(8)[0])
    refused = {
        "outlines must be 2, as the elements, got 1": [one],
        "outlines must be shared by elements that share a law": [one, an_outline()],
        "knots of outline 0 must be from 1 to 16, got 17": [an_outline(17)] * 2,
        r"coefficients of powers of outline 0 must have shape \(9, 36\)": [
            an_outline(polynomial=own, distances=np.array([0.004, 0.003, 0.002]))
        ]
        * 2,
        "tensions of elements and outlines must have one box": [an_outline(polynomial=other_box)] * 2,
        "coefficients of outline 0 must be finite in single precision": [
            an_outline(polynomial=replace(own, coefficients=own.coefficients + 1e39))
        ]
        * 2,
        "knots of outline 0 must lie one after another in its rubber": [an_outline(distances=one.distances[::-1])] * 2,
    }
    for message, outlines in refused.items():
        with pytest.raises(ModelError, match=message):
            native.struct(a_segment(outlines))
    assert native.struct(a_segment([one] * 2)).knots == 6


def test_knots_are_closer_where_a_plate_or_the_clamp_hinders_warping(rod_elements):
    law = rod_elements.outlines["interior"]
    counts = [len(outline_of(law, Piece(kind, 0.010), 0.0).distances) for kind in ("interior", "clamp")]
    assert counts == [2, 4]
