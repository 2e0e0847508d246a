"""Friction of tendons in motion: none, slow, in free vibration, in contact; its work, and what is refused."""

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest
from assembled import two_segments

import rom
from rom import GuidedFinger, MovingFinger
from rom.dataset.rigid_motion import BaseMotion
from rom.files.checked_file import ModelError

DENSITY, AWAY, FRICTION = 1100.0, 0.05, 0.2  # [kg/m^3], of the plane [m], [-]
SOON, DAMPING = [[0.2, 1e-4], [0.1, 2e-4]], [[0.2, 5e-3]]  # branches: moduli [-], times [s]


@pytest.fixture(scope="module")
def finger():
    return rom.load()


def with_branches(finger, branches):
    scene = finger.rod.scene | {"material": finger.rod.scene["material"] | {"prony": branches}}
    return replace(finger, rod=rom.Rod(elements=finger.rod.elements, scene=scene))


@pytest.fixture(scope="module")
def relaxing(finger):
    return with_branches(finger, SOON)


@pytest.fixture(params=["finger", "relaxing"])
def either(request):
    return request.getfixturevalue(request.param)


def moving(finger, point, friction=FRICTION, **more) -> MovingFinger:
    return MovingFinger(finger, point, DENSITY, friction=friction, **more)


def vibrating(finger, friction, radius=1.0, steps=240) -> list:
    """States after a pulse of F1, with all motors' tensions held."""
    one, length = moving(finger, [20.0, 0.0, AWAY], friction, radius=radius), 5e-4
    for k in range(1, 21):
        one.step([20.0 + 4.0 * np.sin(np.pi * k / 20) ** 2, 0.0, AWAY], length)
    return [one.step([20.0, 0.0, AWAY], length) for _ in range(steps)]


def test_without_friction_the_finger_moves_as_one_without_guides(either):
    plain, other = MovingFinger(either, [5.0, 0.0, 0.01], DENSITY), moving(either, [5.0, 0.0, 0.01], 0.0)
    for k in range(100):  # it swings against the plane
        point = [5.0 + 0.4 * k, 0.1 * k, 0.01]
        one, same = plain.step(point, 1e-3), other.step(point, 1e-3)
        assert same.status == one.status == "converged" and same.dissipated == 0.0
        assert same.tip == pytest.approx(one.tip, abs=1e-12) and same.velocity == pytest.approx(one.velocity, abs=1e-9)
    assert one.contact_forces[0] > 0 and same.contact_forces == pytest.approx(one.contact_forces, abs=1e-9)
    assert np.array_equal(other.element_tensions, plain.element_tensions)


@pytest.mark.parametrize("d", [AWAY, 0.01])
@pytest.mark.parametrize("at_rest", [True, False])
def test_slow_motion_has_the_tensions_of_increments_at_rest(either, d, at_rest):
    begun, steps = np.array([10.0, 5.0]), 16 if at_rest else 100
    one, still = moving(either, [*begun, d], radius=0.0), GuidedFinger(model=either, friction=FRICTION)
    for share in np.arange(1, 9) / 8:
        still.advance([*share * begun, d])
    dissipated = still.dissipated
    for goal in ([60.0, 5.0], [60.0, 30.0], [50.0, 30.0], [30.0, 10.0]):
        for k in range(1, steps + 1):
            point = [*(begun + k / steps * (goal - begun)), d]
            state = one.step(point, 1e-2, at_rest=at_rest)
            if k % (steps // 4) == 0:
                wanted = still.advance(point)
        begun = np.array(goal)
        assert state.status == "converged"
        assert np.abs(one.element_tensions - wanted.element_tensions).max() < 0.005 * max(goal)
        assert np.linalg.norm(state.tip - wanted.tip) < 1e-3 * np.linalg.norm(wanted.tip)
        assert state.contact_forces == pytest.approx(wanted.contact_forces, abs=0.05)
    assert state.dissipated == pytest.approx(wanted.dissipated - dissipated, rel=0.02)


def test_a_finger_at_rest_stays_so(either):
    one = moving(either, [30.0, 10.0, AWAY])
    states = [one.step([30.0, 10.0, AWAY], 1e-3) for _ in range(20)]
    assert max(state.kinetic_energy for state in states) < 1e-15
    assert states[-1].tip == pytest.approx(states[0].tip, abs=1e-10) and states[-1].dissipated < 1e-10


def test_a_free_vibration_only_loses_energy_and_more_with_more_friction(finger):
    left = []
    for friction in (0.0, 0.05, 0.1, 0.2):
        states = vibrating(finger, friction)  # the method itself has no damping
        assert all(state.status == "converged" for state in states)
        energies = np.array([state.kinetic_energy for state in states]).reshape(6, -1).max(axis=1)
        taken = np.diff([state.dissipated for state in states])
        assert (taken > -1e-10).all()
        assert (energies[1:] < 1.01 * energies[:-1]).all()
        left.append(energies[-1])
    assert left[0] > 7e-4 and (np.diff(left) < 0).all() and left[-1] < 0.01 * left[0]


def test_relaxing_rubber_vibrates_less_with_more_friction(finger):
    left, relaxing = [], with_branches(finger, DAMPING)
    for friction in (0.0, 0.02, 0.05, 0.1):
        states = vibrating(relaxing, friction, steps=160)
        assert all(state.status == "converged" for state in states)
        assert (np.diff([state.dissipated for state in states]) > -1e-10).all()
        left.append(max(state.kinetic_energy for state in states[120:]))
    assert (np.diff(left) < 0).all() and left[-1] < 0.2 * left[0]


def test_a_step_without_an_answer_leaves_tendons_and_branches_as_they_were(relaxing):
    rest, spin = (BaseMotion(np.zeros(3), np.array([0.0, 0.0, one]), np.zeros(3)) for one in (0.0, 50.0))
    one = moving(relaxing, [20.0, 0.0, AWAY])
    one.step([25.0, 0.0, AWAY], 1e-3, rest)
    other = copy.deepcopy(one)
    assert one.step([60.0, 0.0, AWAY], 10.0, spin).status == "no_equilibrium"
    after, same = (own.step([28.0, 5.0, AWAY], 1e-3, rest) for own in (one, other))
    assert np.array_equal(after.tip, same.tip) and np.array_equal(after.velocity, same.velocity)
    assert np.array_equal(one.element_tensions, other.element_tensions) and after.dissipated == same.dissipated


def test_what_is_left_of_a_vibration_when_all_guides_stick_does_not_grow(finger):
    energies = np.array([state.kinetic_energy for state in vibrating(finger, 0.3, steps=960)])[480:]
    windows = energies.reshape(4, -1).max(axis=1)
    assert 0 < windows.max() < 0.01 * 8e-4 and windows[-1] < 1.05 * windows[0]


def test_what_friction_takes_is_what_the_vibration_loses(finger):
    # of kinetic energy at the passage of the middle, where the elastic one is the same but for what sticks
    states = vibrating(finger, 0.02, steps=160)
    energies, taken = np.array([[state.kinetic_energy, state.dissipated] for state in states]).T
    peaks = np.flatnonzero((energies[1:-1] > energies[:-2]) & (energies[1:-1] > energies[2:])) + 1
    first, last = peaks[0], peaks[-1]
    assert len(peaks) > 5
    assert energies[first] - energies[last] == pytest.approx(taken[last] - taken[first], rel=0.1)


def test_a_long_tendon_rubs_in_both_segments():
    model = two_segments()
    one, still = moving(model, [5.0, 2.0, 0.1], radius=0.0), GuidedFinger(model=model, friction=FRICTION)
    for tension in (5.0, 8.0, 11.0, 8.0):
        for _ in range(8):
            state = one.step([tension, 2.0, 0.1], 0.02, at_rest=True)
        wanted = still.advance([tension, 2.0, 0.1])
    assert state.status == "converged" and one.element_tensions.shape == (10, 2)
    assert one.element_tensions == pytest.approx(wanted.element_tensions, abs=0.05)
    assert (one.element_tensions[:, 0] > 8.0).all()  # released from 11 N: guides hold the tendon back


def test_a_copy_has_a_history_of_its_own(either):
    one = moving(either, [20.0, 0.0, AWAY])
    one.step([25.0, 0.0, AWAY], 1e-3)
    others = [copy.deepcopy(one), pickle.loads(pickle.dumps(one))]
    tips = [own.step([15.0, 5.0, AWAY], 1e-3).tip for own in (one, *others)]
    assert np.array_equal(tips[0], tips[1]) and np.array_equal(tips[0], tips[2])


def test_what_cannot_rub_is_refused(finger):
    with pytest.raises(ModelError, match="friction must be a number of at least 0"):
        moving(finger, [0.0, 0.0, AWAY], -0.1)
    with pytest.raises(ModelError, match="parameters must be where the finger can rest"):
        moving(finger, [300.0, 0.0, AWAY])
    with pytest.raises(ModelError, match="friction of tendons must be left out for frequencies"):
        moving(finger, [0.0, 0.0, AWAY]).frequencies([0.0, 0.0])
