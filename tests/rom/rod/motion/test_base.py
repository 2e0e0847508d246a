"""A base that moves: its acceleration is weight, its turning turns the weight, and a steady one is a static load."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import rom
from rom.dataset.rigid_motion import BaseMotion
from rom.files.checked_file import ModelError
from rom.rod.motion.base import Base
from rom.rod.motion.moving_finger import MovingFinger

DENSITY, AWAY, POINT = 1100.0, 0.03, [10.0, 3.0, 0.03]
GRAVITY, NONE = np.array([0.0, -9.80665, 0.0]), np.zeros(3)


@pytest.fixture(scope="module")
def light():
    return rom.load()


@pytest.fixture(scope="module")
def heavy(light):
    weight = {"density": DENSITY, "direction": GRAVITY.tolist()}
    return replace(light, rod=light.rod.assembled(light.rod.scene | {"gravity": weight}))


def settled(finger, base: BaseMotion | None, **more):
    one = MovingFinger(finger, POINT, DENSITY, radius=0.0, **more)
    for _ in range(30):
        state = one.step(POINT, 0.1, base)
    return one, state


def test_a_constant_acceleration_is_weight_and_free_fall_takes_it_away(light, heavy):
    risen, fallen = (settled(one, BaseMotion(a, NONE, NONE))[1] for one, a in ((light, -GRAVITY), (heavy, GRAVITY)))
    assert risen.tip == pytest.approx(heavy.evaluate(POINT).tip, abs=1e-9)
    assert fallen.tip == pytest.approx(light.evaluate(POINT).tip, abs=1e-9)
    assert np.linalg.norm(risen.tip - fallen.tip) > 1e-5


def test_a_base_that_has_turned_sees_the_weight_turned(heavy):
    one, rate = MovingFinger(heavy, POINT, radius=0.0), np.array([0.0, 0.3, 1.0])
    for _ in range(100):
        one.step(POINT, 0.01, BaseMotion(NONE, rate, NONE))
    for _ in range(40):
        state = one.step(POINT, 0.1)
    base = Base(BaseMotion(NONE, NONE, NONE), np.eye(3))
    for _ in range(100):
        base = base.after(BaseMotion(NONE, rate, NONE), 1.0, 0.01)
    base = base.after(BaseMotion(NONE, NONE, NONE), 1.0, 0.1)
    assert Rotation.from_matrix(base.rotation).as_rotvec() == pytest.approx(1.045 * rate, abs=1e-9)  # two ramps
    assert state.tip == pytest.approx(heavy.with_gravity(base.rotation.T @ GRAVITY).evaluate(POINT).tip, abs=1e-9)


def test_a_finger_that_turns_about_its_clamp_is_stretched_as_a_bar():
    """By w^2 (rho L^3 / 3 + m x L / A) / E, with the plate's mass m at x; plates hinder the rubber next to them."""
    finger, spin = rom.load(), 100.0
    one = MovingFinger(finger, [0.0, 0.0, AWAY], DENSITY, radius=0.0)
    for _ in range(30):
        state = one.step([0.0, 0.0, AWAY], 0.1, BaseMotion(NONE, np.array([0.0, 0.0, spin]), NONE))
    segment, length, plate = finger.rod.segments[0], 0.049, 7850.0 * 0.001 * 1e-4
    load = DENSITY * length**3 / 3 + plate * 0.0495 * length / segment.area
    at_rest = finger.evaluate([0.0, 0.0, AWAY]).tip
    assert state.tip[0] - at_rest[0] == pytest.approx(spin**2 * load / segment.young_modulus, rel=0.02)


def test_more_sections_hardly_change_what_a_turning_base_does():
    """By its rate and by itself: 20 ms of a growing turn, after which the finger has bent by some micrometres."""
    tips = []
    for parts in (1, 3):
        one = MovingFinger(rom.load(), [0.0, 0.0, AWAY], DENSITY, parts=parts)
        begun = one.model.evaluate([0.0, 0.0, AWAY]).tip
        for k in range(1, 41):
            base = BaseMotion(NONE, np.array([0.0, 20.0, 150.0 * k * 5e-4]), np.array([0.0, 0.0, 150.0]))
            state = one.step([0.0, 0.0, AWAY], 5e-4, base)
        tips.append(state.tip - begun)
    assert tips[0] == pytest.approx(tips[1], rel=0.02, abs=5e-8) and np.linalg.norm(tips[0]) > 1e-6


@pytest.mark.parametrize("name", ["acceleration", "spin", "spin_rate"])
def test_a_base_of_no_numbers_is_refused(name):
    one, base = MovingFinger(rom.load(), POINT, DENSITY), BaseMotion(NONE, NONE, NONE)
    for wrong in (np.zeros(2), np.array([0.0, np.nan, 0.0])):
        with pytest.raises(ModelError, match=f"base.{name} must be three finite numbers"):
            one.step(POINT, 1e-3, base._replace(**{name: wrong}))


def test_a_base_that_turns_too_far_in_a_step_is_followed_in_shorter_ones():
    spin = BaseMotion(NONE, np.array([0.0, 0.0, 50.0]), NONE)
    one, finer = (MovingFinger(rom.load(), POINT, DENSITY, radius=0.0) for _ in range(2))
    one.step(POINT, 0.02, spin)
    assert one.time == pytest.approx(0.02)
    with pytest.raises(ModelError):
        finer.step(POINT, 0.0, spin)
    assert finer.step(POINT, 10.0, spin).status == "no_equilibrium"  # more than 0.3 rad in the shortest
