"""Tapered rods of scaled prismatic elements against an elastic rod of changing section, solved without elements."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rom.dataset.geometry import size_at
from rom.elements.elements import INTERIOR
from rom.elements.law import ElementLaw
from rom.elements.march import march
from rom.elements.pieces import Piece
from rom.elements.polynomial import Polynomial
from rom.elements.taper import TaperedRubber, shear_by_bending, tapered, tapered_pieces
from rom.files.checked_file import ModelError
from tests.rom.elements import elastic_rod as rod

TENSIONS, WRENCH = np.array([8.0, 5.0]), np.array([0.05, -0.1, 0.08, 1e-3, -2e-3, 2e-3])


def scene_of(*ratios: float, share: float = 1.0) -> dict:
    """A scene of the elastic rod with a segment for each ratio, tensions to a share of the trained ones."""
    scene = rod.in_series(*[rod.LENGTH] * len(ratios))
    tendons = [tendon | {"tension": [0.0, share * rod.MOST_TENSION]} for tendon in scene["tendons"]]
    return scene | {"geometry": scene["geometry"] | {"taper": list(ratios)}, "tendons": tendons}


def plate(tensions: np.ndarray, wrench: np.ndarray, taper: float) -> tuple[np.ndarray, np.ndarray]:
    """Centre and rotation of the elastic rod's plate: stiffnesses go with the sections' squares and fourth powers."""
    rubber, axis = rod.LENGTH - taper * rod.PLATE, np.array([1.0, 0.0, 0.0])
    bent = tensions @ np.cross(np.insert(rod.TWO, 0, 0.0, axis=1), -axis)
    stiff = np.array([rod.TORSION, rod.BENDING, rod.BENDING])

    def slope(u: float, state: np.ndarray) -> np.ndarray:
        place, turned = state[:3], state[3:].reshape(3, 3)
        size = taper + (1 - taper) * u / rubber
        strain = (turned.T @ wrench[:3] - tensions.sum() * axis)[0] / (rod.AXIAL * size**2)
        curved = (turned.T @ (wrench[3:] - np.cross(place, wrench[:3])) + size * bent) / (stiff * size**4)
        spin = np.cross(curved, np.eye(3)).T
        return np.concatenate([-(1 + strain) * turned[:, 0], (-turned @ spin).ravel()])

    begin = np.concatenate([[-taper * rod.PLATE / 2, 0.0, 0.0], np.eye(3).ravel()])
    end = solve_ivp(slope, (0.0, rubber), begin, rtol=1e-10, atol=1e-12).y[:, -1]
    turned = end[3:].reshape(3, 3)
    return -turned.T @ end[:3], turned.T


def test_a_polynomial_on_a_smaller_box_is_the_same():
    random = np.random.default_rng(0)
    powers = np.array([[a, b] for a in range(5) for b in range(4)])
    lower, upper = np.array([0.0, -2.0]), np.array([3.0, 2.0])
    whole = Polynomial(lower=lower, upper=upper, powers=powers, coefficients=random.standard_normal((len(powers), 2)))
    part = whole.on(np.array([0.5, -2.0]), np.array([1.0, 1.0]))
    points = random.uniform([0.5, -2.0], [1.0, 1.0], (50, 2))
    assert part.value(points) == pytest.approx(whole.value(points), abs=1e-12)
    assert len(part.powers) == len(whole.powers)


@pytest.mark.parametrize(("begin", "end"), [(1.0, 0.6), (0.7, 1.0), (1.0, 1.3)])
def test_pieces_follow_each_other_and_are_of_their_own_size(begin, end):
    lengths = {"clamp": (0.0103, 0.0103), "interior": (0.0026, 0.0103), "plate": (0.0108, 0.0108)}
    rubber = TaperedRubber(begin, end, 0.0495 + end * 0.0005, 0.0005)
    found = tapered_pieces(lengths, rubber)
    assert sum(one.length for one in found) == pytest.approx(0.0495 + end * 0.0005, rel=1e-9)
    assert found[0].length == pytest.approx(found[0].size * 0.0108, rel=1e-9)
    assert found[-1].length == pytest.approx(found[-1].size * 0.0103, rel=1e-9)
    assert all(one.length <= one.size * 0.0103 * (1 + 1e-6) for one in found[1:-1])
    assert all(one.ends[1] == pytest.approx(other.ends[0], rel=1e-9) for one, other in pairwise(found))
    assert (found[0].ends[0], found[-1].ends[1]) == pytest.approx((end, begin), rel=1e-9)
    assert all(min(one.ends) <= one.size <= max(one.ends) for one in found)


def test_a_segment_shorter_than_its_end_pieces_is_refused():
    lengths = {"clamp": (0.0103, 0.0103), "interior": (0.0026, 0.0103), "plate": (0.0108, 0.0108)}
    with pytest.raises(ModelError, match=r"segment must be longer than 0.01\d+ m from clamp to plate's centre"):
        tapered_pieces(lengths, TaperedRubber(1.0, 0.7, 0.015, 0.0005))
    with pytest.raises(ModelError, match="taper needs an interior element"):
        tapered_pieces({"whole": (0.0495, 0.0495)}, TaperedRubber(1.0, 0.7, 0.0495, 0.0005))


@pytest.mark.parametrize("taper", [0.9, 0.7, 1.2])
def test_a_tapered_finger_bends_as_the_rod_does(finger, taper):
    """An elastic rod has no shear; what differs is of second order in the ratio of an element's sizes."""
    found = finger.assembled(scene_of(taper, share=min(taper, 1.0) ** 2))
    second = max(np.log(piece.ends[0] / piece.ends[1]) ** 2 for piece in found.pieces[0])
    for wrench in (np.zeros(6), WRENCH):
        placed, (centre, turned) = found.place(TENSIONS, wrench[None]), plate(TENSIONS, wrench, taper)
        assert placed.inside
        assert np.abs(placed.rotations[0] - turned).max() < 1e-4 + 0.05 * second
        assert np.linalg.norm(placed.centres[0] - centre) < 3e-6 + 0.05 * second * np.linalg.norm(centre - found.rest)


def test_a_taper_that_vanishes_is_none(finger):
    straight, almost = finger.place(TENSIONS, WRENCH[None]), finger.assembled(scene_of(1 - 1e-9, share=0.99))
    assert almost.place(TENSIONS, WRENCH[None]).centres == pytest.approx(straight.centres, abs=1e-9)
    one = finger.assembled(scene_of(1.0)).place(TENSIONS, WRENCH[None])
    assert np.array_equal(one.centres, straight.centres) and np.array_equal(one.motions, straight.motions)


def test_a_segment_behind_a_taper_is_one_of_its_size(finger):
    """The second of two segments is straight: it is the finger scaled by similarity, under forces as much smaller."""
    size = 0.8
    two = finger.assembled(scene_of(size, 1.0, share=size**2))
    small = finger.assembled(
        rod.similar(size, 1.0) | {"geometry": rod.similar(size, 1.0)["geometry"] | {"segments": [rod.LENGTH]}}
    )
    pressed = np.vstack([np.zeros(6), WRENCH])
    placed, alone = two.place(TENSIONS, pressed), small.place(TENSIONS, WRENCH[None])
    ahead = placed.rotations[0].T @ (placed.centres[1] - placed.centres[0]) - [size * rod.PLATE / 2, 0.0, 0.0]
    assert ahead == pytest.approx(alone.centres[0], abs=1e-9)
    assert placed.rotations[0].T @ placed.rotations[1] == pytest.approx(alone.rotations[0], abs=1e-9)


def test_compiled_code_is_the_march(finger):
    found = finger.assembled(scene_of(0.7, share=0.49))
    marched = march(found.segments[0].elements, TENSIONS[None], WRENCH[None])
    placed = found.place(TENSIONS, WRENCH[None])
    assert placed.centres[0] == pytest.approx(marched.plate[0][0], abs=1e-12)
    assert placed.rotations[0] == pytest.approx(marched.plate[1][0], abs=1e-11)
    assert placed.motions[0] == pytest.approx(marched.motion[0], rel=1e-8, abs=1e-12)


def test_tensions_beyond_those_of_the_thinnest_section_are_refused_or_marked(finger):
    with pytest.raises(ModelError, match=r"F1.tension must lie in 0 to 19.6 N, where the elements were trained"):
        finger.assembled(scene_of(0.7, share=0.5))
    found = finger.assembled(scene_of(0.7, share=0.49))
    assert found.place([19.0, 19.0]).inside and not found.place([30.0, 0.0]).inside


INPUTS = [0, 1, 2, 3, 5, 6]  # all but a moment about x
STIFF, SHEAR, CURVED = 2e-3, 3e-3, 5.0  # at size 1: E I [N m^2], c [1/N], curvature by tension [1/(N m)]


def timoshenko(piece: Piece, axial: float) -> np.ndarray:
    """Place y, z and half turns about y, z of a Timoshenko frustum, by a tendon and f_x, f_y, f_z, m_y, m_z.

    Integrals over sections of their own size, shape (4, 6). The tendon's moment M about the centre shears by p M, as
    its force is along the channel. An axial force bends by `axial` at size 1 [1/(N m)], where the neutral axis is off
    the centre, and does not shear.
    """
    u, weights = np.polynomial.legendre.leggauss(20)
    u, weights = piece.length * (u + 1) / 2, piece.length * weights / 2
    slope = (piece.ends[1] - piece.ends[0]) / piece.length
    size = piece.ends[0] + slope * u
    stiff = STIFF * size**4
    curved = np.array([(CURVED - axial) / size**3, axial / size**3, u / stiff, 1 / stiff])
    shear = np.outer([slope * CURVED * STIFF, 0.0, 1.0, 0.0], SHEAR / size**2)
    turns, places = curved @ weights, curved @ (weights * (piece.length - u)) - shear @ weights
    found = np.zeros((4, 6))
    found[0, [0, 1, 2, 5]], found[3, [0, 1, 2, 5]] = places, -turns / 2
    found[1, [3, 4]], found[2, [3, 4]] = places[2:] * [1, -1], turns[2:] / 2 * [1, -1]
    return found


def linear_law(length: float, size: float = 1.0, axial: float = 0.0) -> ElementLaw:
    """The prismatic element of that frustum: a law of a tension and the wrench."""
    gradient = np.zeros((6, 7))
    gradient[np.ix_([1, 2, 4, 5], INPUTS)] = timoshenko(Piece(INTERIOR, length, (size, size)), axial)
    lower, upper = np.full(7, -2.0), np.full(7, 2.0)
    powers = np.vstack([np.zeros(7, int), np.eye(7, dtype=int)])
    coefficients = np.vstack([np.zeros(6), (gradient * upper).T])
    law = Polynomial(lower=lower, upper=upper, powers=powers, coefficients=coefficients)
    tensions = np.array([[0.0], [2.0]])
    return ElementLaw(tension_map=np.eye(1), tensions=tensions, polynomial=law, lengths=(length, length))


def test_shear_by_bending_is_that_of_the_beam():
    assert shear_by_bending(linear_law(0.01)) == pytest.approx(2 * [SHEAR * STIFF], rel=1e-9)


@pytest.mark.parametrize(("ratio", "axial", "corrected"), [(0.95, 0.0, 5), (0.9, 0.0, 5), (1.1, 0.0, 5), (0.9, 2.0, 6)])
def test_an_element_is_its_frustum_in_first_order(ratio, axial, corrected):
    piece = Piece(INTERIOR, 0.01, (ratio, 1.0))
    element, inputs = linear_law(piece.length, piece.size, axial).of_length(piece.length), np.eye(7)[INPUTS]
    laws = element, tapered(element, piece, np.full(2, SHEAR * STIFF), np.ones(1))
    expected = timoshenko(piece, axial)
    own = expected != 0
    prismatic, found = (np.abs(one.value(inputs)[:, [1, 2, 4, 5]].T - expected)[own] for one in laws)
    scales = np.abs(expected)[own]
    assert (found < 0.5 * np.log(ratio) ** 2 * scales).all()
    assert (
        prismatic > 0.1 * abs(np.log(ratio)) * scales
    ).sum() == corrected  # places by tension, axial force and moments; turns by forces


def test_points_of_a_tapered_finger_are_on_its_surface(finger):
    found = finger.assembled(scene_of(0.7, share=0.49))
    halves = rod.SIDE / 2 * size_at(found.scene["geometry"], found.edges[:, 0])
    assert np.abs(found.edges[:, 1:]) == pytest.approx(np.column_stack([halves, halves]))
    assert np.abs(found.displacement(np.zeros(2))).max() < 1e-6
    with pytest.raises(ModelError, match="points must lie in the finger at rest"):
        found.displacement(np.zeros(2), points=[[0.049, 0.004, 0.0]])


def test_more_errors_are_expected_of_a_tapered_finger(finger):
    straight, found = finger.errors, finger.assembled(scene_of(0.7, share=0.49)).errors
    for name in ("contact_force", "position", "turn", "shortening", "surface"):
        assert getattr(found, name) > getattr(straight, name)
    assert found.floors.place > straight.floors.place and found.floors.force > straight.floors.force


def test_sections_where_a_tapered_finger_has_none_are_not_made(finger):
    with pytest.raises(ModelError, match=r"geometry.taper must be one ratio above 0 per segment, got \[0.9, 0.9\]"):
        finger.assembled(scene_of(0.9) | {"geometry": scene_of(0.9)["geometry"] | {"taper": [0.9, 0.9]}})
