"""The beams of the comparison agree with closed forms."""

import math

import numpy as np
import pytest

from studies.peers.beams import Arc, CosseratRod, Rubber, answers, corner, tip
from studies.peers.question import CONTACT, Finger, finger


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
    np.testing.assert_allclose(found, tip(of, (x, y, angle)), rtol=0, atol=1e-12)


def test_a_light_push_holds_an_arc_back_by_virtual_work():
    # A small deflection: y = k L^2/2, so its force is (F e - E I k) L/(L^2/2) = 2 (F e - E I k)/L.
    of = slender()
    pull, rubber = tension(of, 0.03), Rubber(of)
    distance = 0.01 * of.length
    _, arc = Arc(of).solve(pull, distance)
    held = 2 * distance / rubber.length**2
    assert arc == pytest.approx(2 * (pull * of.offset - rubber.bending * held) / rubber.length, rel=2e-3)


@pytest.mark.parametrize("beam", [Arc, CosseratRod])
def test_a_touched_plate_is_on_the_plane_and_never_behind_it(beam):
    asked = finger()
    for pull, distance in CONTACT:
        found, force = beam(asked).solve(pull, distance)
        free, _ = beam(asked).solve(pull, None)
        assert force > 0
        assert found[1] != pytest.approx(free[1], abs=1e-9)
        assert found[1] < asked.side / 2 + distance


def test_a_free_cosserat_rod_is_an_arc_that_its_tendon_shortens():
    of, pull = finger(), 60.0
    rubber = Rubber(of)
    angle = of.offset * pull / rubber.bending * rubber.length
    radius = (1 - pull / rubber.axial) * rubber.length / angle
    x, y, turned = CosseratRod(of).end(pull)
    np.testing.assert_allclose(
        [x, y, turned], [radius * math.sin(angle), radius * (1 - math.cos(angle)), angle], rtol=1e-8
    )


def test_a_light_push_bends_a_cosserat_rod_as_a_cantilever():
    # y = F e L^2 / (2 E I) - p L^3 / (3 E I) at the end of a slender one.
    of = slender()
    pull, rubber, distance = tension(of, 0.03), Rubber(of), 0.01
    _, force = CosseratRod(of).solve(pull, distance)
    free = pull * of.offset * rubber.length**2 / (2 * rubber.bending)
    assert force == pytest.approx(3 * rubber.bending / rubber.length**3 * (free - distance), rel=2e-3)


def test_strains_of_a_cosserat_rod_minimise_its_energy():
    of, pull, force, moment = finger(), 40.0, (-1.0, 2.0), 0.02
    rubber, rod = Rubber(of), CosseratRod(of)

    def energy(v, g, k):
        own = rubber.axial * (v - 1) ** 2 / 2 + rubber.shear * g**2 / 2 + rubber.bending * k**2 / 2
        return own + pull * math.hypot(v - of.offset * k, g) - force[0] * v - force[1] * g - moment * k

    at = rod.strains(pull, force, moment)
    for axis, step in enumerate((1e-6, 1e-6, 1e-4)):
        moved = [energy(*np.add(at, sign * step * np.eye(3)[axis])) for sign in (1, -1)]
        assert (moved[0] - moved[1]) / (2 * step) == pytest.approx(0.0, abs=1e-6 * pull)


def test_the_higher_far_corner_is_half_a_side_from_the_middle_of_the_plates_face():
    of = finger()
    for angle in (0.7, 2.0):
        c, s = math.cos(angle), math.sin(angle)
        middle = np.array([0.01 + of.plate * c, 0.02 + of.plate * s])
        found = np.array(corner(of, (0.01, 0.02, angle)))
        assert np.linalg.norm(found - middle) == pytest.approx(of.side / 2) and found[1] >= middle[1]


@pytest.mark.parametrize("beam", [Arc, CosseratRod])
def test_a_beam_answers_every_state(beam):
    found = answers(beam(finger()).solve, name="beam", settings="", limits="")
    assert None not in [*found.free_tips, *found.contact_tips, *found.contact_forces]
