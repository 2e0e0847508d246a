"""What is told of rods is what closed forms say, as far as it needs neither elastica nor mujoco."""

import math

import numpy as np
import pytest

from studies.peers.question import CONTACT, FREE, Finger, finger
from studies.peers.rods.asking import Rubber, Told, corners, tip
from studies.peers.rods.constant_curvature import Arc, Elastica, measure


def slender(length: float = 1.0, side: float = 0.002) -> Finger:
    """So thin and with so little a plate that it touches by its very tip; tendon at a tenth of its length."""
    return Finger(length=length, side=side, plate=1e-7, offset=0.1, C1=1e9, D1=1e-9)


def tension(of: Finger, angle: float) -> float:
    """That bends it by an angle."""
    return angle * Rubber(of).bending / (of.offset * Rubber(of).length)


def test_moduli_are_those_of_small_strains():
    assert finger().young == pytest.approx(9.88e6, rel=1e-3)
    assert finger().poisson == pytest.approx(0.300, abs=1e-3)


@pytest.mark.parametrize("angle", [0.3, 1.0, 2.5])
def test_a_tendon_bends_a_free_finger_into_an_arc(angle):
    of = finger()
    pull = tension(of, angle)
    length = Rubber(of).length * (1 - pull / Rubber(of).axial)
    x, y = length * math.sin(angle) / angle, length * (1 - math.cos(angle)) / angle
    for solve in (Arc(of, per_rest_length=True).solve, Elastica(of, 32).solve):
        found, force = solve(pull, None)
        assert force == 0
        np.testing.assert_allclose(found, tip(of, x, y, angle), rtol=0, atol=1e-7 * of.length)


def test_an_arc_curved_per_length_as_it_is_turns_by_less_as_its_tendon_shortens_it():
    of = finger()
    pull = tension(of, 1.0)
    short = 1 - pull / Rubber(of).axial
    length, angle = Rubber(of).length * short, short
    x, y = length * math.sin(angle) / angle, length * (1 - math.cos(angle)) / angle
    np.testing.assert_allclose(Arc(of).solve(pull, None)[0], tip(of, x, y, angle), rtol=0, atol=1e-12)


@pytest.mark.parametrize(("share", "expected"), [(1.25, 0.07588679), (2.0, 0.30389948)])
def test_a_slender_elastica_is_pushed_back_as_in_the_linear_boundary_value_problem(share, expected):
    # theta' = m - r (x_tip - x), touched at d/L = 0.1 where m = 0.2006725111; solved to all digits elsewhere.
    of = slender()
    _, force = Elastica(of, 64).solve(tension(of, share * 0.2006725111), 0.1 * of.length)
    assert force * Rubber(of).length ** 2 / Rubber(of).bending == pytest.approx(expected, rel=2e-3)


def test_a_light_push_holds_an_arc_back_by_virtual_work():
    # A small deflection: y = k L^2/2, so its force is (F e - E I k) L/(L^2/2) = 2 (F e - E I k)/L, 4/3 of a beam's.
    of = slender()
    pull, rubber = tension(of, 0.03), Rubber(of)
    distance = 0.01 * of.length
    _, arc = Arc(of).solve(pull, distance)
    _, beam = Elastica(of, 64).solve(pull, distance)
    held = 2 * distance / rubber.length**2
    assert arc == pytest.approx(2 * (pull * of.offset - rubber.bending * held) / rubber.length, rel=2e-3)
    assert arc == pytest.approx(4 / 3 * beam, rel=5e-3)


@pytest.mark.parametrize("of", [Arc, lambda asked: Elastica(asked, 32)])
def test_a_touched_plate_is_on_the_plane_and_never_behind_it(of):
    asked = finger()
    model = of(asked)
    for pull, distance in CONTACT:
        found, force = model.solve(pull, distance)
        free, _ = model.solve(pull, None)
        assert force > 0
        assert found[1] != pytest.approx(free[1], abs=1e-9)
        assert found[1] < asked.side / 2 + distance


def test_a_plane_out_of_reach_pushes_nothing():
    for pull in FREE:
        free, _ = Elastica(finger(), 16).solve(pull, None)
        assert Elastica(finger(), 16).solve(pull, 0.2) == (free, 0.0)


def test_the_far_corners_are_half_a_side_from_the_middle_of_the_plates_face():
    of = finger()
    upper, lower = corners(of, 0.01, 0.02, 0.7)
    assert math.dist(upper, lower) == pytest.approx(of.side)
    middle = np.add(upper, lower) / 2
    np.testing.assert_allclose(middle, [0.01 + of.plate * math.cos(0.7), 0.02 + of.plate * math.sin(0.7)])


def test_the_elastica_no_longer_changes_with_its_steps():
    *arcs, elastica = measure()
    assert elastica.refinement[-2]["tip"] < 1e-5
    assert elastica.refinement[-2]["contact_force_max"] < 1e-5
    assert None not in [*elastica.contact_forces, *(force for arc in arcs for force in arc.contact_forces)]


def test_states_without_an_answer_are_left_out_of_differences():
    some = Told(free=[None, [0.0, 1.0, 0.0]], touching=[None], forces=[None], seconds=1.0)
    all_of = Told(free=[[0.0, 1.0, 0.0], [0.0, 2.0, 0.0]], touching=[[0.0, 1.0, 0.0]], forces=[1.0], seconds=1.0)
    assert some.apart(all_of) == {"tip": 0.5, "contact_force": None, "contact_force_max": None}
