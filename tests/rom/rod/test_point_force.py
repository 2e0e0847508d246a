"""Shortenings of tendons where one force presses across a finger, at a position along its axis."""

import numpy as np
import pytest
from assembled import two_segments

import rom
from rom import Sphere, TouchedSegment
from rom.rod.compiled.reports import shortenings, shortenings_by_force

PULLED, FORCE = np.array([50.0, 20.0]), np.array([-1.5, 0.3])  # [N]
TOLERANCE = 0.05  # of what the force shortens: a ball indents the rubber, and presses on a small area [-]
STEPS = np.array([1e-3, 1e-3, 1e-7, 1e-4, 1e-4])  # of two tensions [N], the position [m] and the force [N]


def by_inputs(compiled, inputs: np.ndarray) -> np.ndarray:
    return shortenings_by_force(compiled, inputs[:2], float(inputs[2]), inputs[3:])[0]


@pytest.mark.parametrize("share", [0.08, 0.3, 0.45, 0.49, 0.5, 0.51, 0.7, 0.97, 0.992])
def test_derivatives_are_differences_along_two_segments(share):
    rod = two_segments().rod
    inputs = np.array([18.0, 6.0, share * rod.rest[0], *FORCE])
    _, found, inside = shortenings_by_force(rod.struct, inputs[:2], float(inputs[2]), inputs[3:])
    wanted = [
        (by_inputs(rod.struct, inputs + one) - by_inputs(rod.struct, inputs - one)) / (2 * step)
        for step, one in zip(STEPS, np.diag(STEPS), strict=True)
    ]
    assert inside and found == pytest.approx(np.array(wanted).T, rel=1e-5, abs=1e-9)


def test_a_force_at_the_plate_s_centre_is_its_wrench():
    rod = rom.load().rod
    found, _, _ = shortenings_by_force(rod.struct, PULLED, float(rod.rest[0]), FORCE)
    wanted, _ = shortenings(rod.struct, PULLED, np.array([[0.0, *FORCE, 0.0, 0.0, 0.0]]))
    assert found == pytest.approx(wanted, abs=1e-15)


@pytest.mark.parametrize("position", [0.012, 0.02, 0.027, 0.035, 0.043])
def test_a_ball_on_the_rubber_presses_as_the_force_does(position):
    rod, radius = rom.load().rod, 0.006
    section = rod.sections(PULLED, at=[position])
    outward = section.rotations[0][:, 1]
    ball = Sphere(
        centre=tuple(section.centres[0] + (rod.half_lengths[1] + radius) * outward),
        radius=radius,
        direction=tuple(outward),
        distances=(-0.02, 0.02),
    )
    model = TouchedSegment(rod=rod, obstacle=ball)
    answer = model.evaluate([*PULLED, model.evaluate([*PULLED, np.inf]).touch_distance - 2e-4])
    free = rod.shortening(PULLED)
    found, _, _ = shortenings_by_force(rod.struct, PULLED, position, np.array([-float(answer.contact_force), 0.0]))
    assert answer.inside and answer.contact_force > 0.05
    assert found - free == pytest.approx(answer.shortenings - free, abs=TOLERANCE * np.abs(found - free).max())


def test_a_position_beyond_the_tip_is_outside():
    rod = rom.load().rod
    tip = float(rod.rest[0] + rod.half_lengths[0])
    assert not shortenings_by_force(rod.struct, PULLED, tip + 1e-6, FORCE)[2]
    assert not shortenings_by_force(rod.struct, PULLED, -1e-6, FORCE)[2]
