"""The beams of the comparison agree with closed forms, as far as they do not need PyElastica."""

import math

import numpy as np
import pytest

from studies.peers.question import CONTACT, Finger, finger
from studies.peers.rods.asking import Rubber, corners, tip
from studies.peers.rods.constant_curvature import Arc, measure


def slender(length: float = 1.0, side: float = 0.002) -> Finger:
    """So thin and with so small a plate that it touches at its very tip; tendon at a tenth of its length."""
    return Finger(length=length, side=side, plate=1e-7, offset=0.1, C1=1e9, D1=1e-9)


def tension(of: Finger, angle: float) -> float:
    """That bends it by an angle."""
    return angle * Rubber(of).bending / (of.offset * Rubber(of).length)


def test_moduli_are_those_of_small_strains():
    assert finger().young == pytest.approx(9.88e6, rel=1e-3)
    assert finger().poisson == pytest.approx(0.300, abs=1e-3)


def test_an_arc_turns_by_less_as_its_tendon_shortens_it():
    of = finger()
    pull = tension(of, 1.0)
    short = 1 - pull / Rubber(of).axial
    length, angle = Rubber(of).length * short, short
    x, y = length * math.sin(angle) / angle, length * (1 - math.cos(angle)) / angle
    found, force = Arc(of).solve(pull, None)
    assert force == 0
    np.testing.assert_allclose(found, tip(of, x, y, angle), rtol=0, atol=1e-12)


def test_a_light_push_holds_an_arc_back_by_virtual_work():
    # A small deflection: y = k L^2/2, so its force is (F e - E I k) L/(L^2/2) = 2 (F e - E I k)/L.
    of = slender()
    pull, rubber = tension(of, 0.03), Rubber(of)
    distance = 0.01 * of.length
    _, arc = Arc(of).solve(pull, distance)
    held = 2 * distance / rubber.length**2
    assert arc == pytest.approx(2 * (pull * of.offset - rubber.bending * held) / rubber.length, rel=2e-3)


def test_a_touched_plate_is_on_the_plane_and_never_behind_it():
    asked = finger()
    for pull, distance in CONTACT:
        found, force = Arc(asked).solve(pull, distance)
        free, _ = Arc(asked).solve(pull, None)
        assert force > 0
        assert found[1] != pytest.approx(free[1], abs=1e-9)
        assert found[1] < asked.side / 2 + distance


def test_the_far_corners_are_half_a_side_from_the_middle_of_the_plates_face():
    of = finger()
    upper, lower = corners(of, 0.01, 0.02, 0.7)
    assert math.dist(upper, lower) == pytest.approx(of.side)
    middle = np.add(upper, lower) / 2
    np.testing.assert_allclose(middle, [0.01 + of.plate * math.cos(0.7), 0.02 + of.plate * math.sin(0.7)])


def test_an_arc_answers_every_state():
    found = measure()
    assert None not in [*found.free_tips, *found.contact_tips, *found.contact_forces]
