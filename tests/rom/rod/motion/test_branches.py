"""Viscoelastic rubber: creep, relaxation and an oscillator in closed form; an hour; and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from assembled import in_series

import rom
from rom.files.checked_file import ModelError
from rom.rod.motion.branches import branches_of
from rom.rod.motion.moving_finger import MovingFinger
from rom.rod.scene.scene_of_rod import rescaled

DENSITY, AWAY = 1100.0, 0.03
MODULUS, TIME = 0.5, 2.0  # of a branch [-], [s]


def soft(*branches):
    """The bundled finger with branches."""
    finger = rom.load()
    material = finger.rod.scene["material"] | {"prony": [list(one) for one in branches]}
    return replace(finger, rod=finger.rod.assembled(finger.rod.scene | {"material": material}))


def relaxing(finger, modulus=MODULUS, time=TIME):
    """Young's modulus of a finger with one branch, as a branch: modulus over the relaxed one, and time.

    By 1/E = 1/(3 mu) + 1/(9 K) in the Laplace domain.
    """
    r = branches_of(finger.rod)["bulk"]
    own = time * (1 + r * (1 + modulus)) / (1 + r)
    return (1 + modulus) * time / own - 1, own


@pytest.mark.parametrize("segments", [1, 2])
def test_the_tip_creeps_as_the_rubber_does(segments):
    finger = soft((MODULUS, TIME))
    finger = replace(finger, rod=in_series(finger.rod, segments))
    g, tau = relaxing(finger)
    one, pulled = MovingFinger(finger, [0.0, 0.0, AWAY], DENSITY, radius=0.0), [0.2, 0.0, AWAY]
    begun, relaxed = (finger.evaluate([force, 0.0, AWAY]).tip[1] for force in (0.0, 0.2))
    tips = []
    one.step(pulled, 1e-6, at_rest=True)
    for _ in range(200):
        tips.append(one.step(pulled, TIME / 50, at_rest=True).tip[1])
    times = TIME / 50 * np.arange(1, 201)
    wanted = 1 - g / (1 + g) * np.exp(-times / tau / (1 + g))
    assert (np.array(tips) - begun) / (relaxed - begun) == pytest.approx(wanted, abs=1e-3)
    assert wanted[0] < 0.73 and wanted[-1] > 0.98


def test_a_held_force_relaxes_as_the_rubber_does():
    """F(t) = (d R(t) - c T) / c', where the tip moves by c a tension and c' a force: both by differences at rest."""
    finger, d, pull = soft((MODULUS, TIME)), 0.0015, 12.0
    g, tau = relaxing(finger)
    held, free = float(finger.evaluate([pull, 0.0, d]).contact_force), finger.evaluate([pull, 0.0, AWAY])
    reach = float(free.touch_distance)
    one = MovingFinger(finger, [0.0, 0.0, d], DENSITY, radius=0.0)
    one.step([pull, 0.0, d], 1e-6, at_rest=True)
    times, forces = [], []
    for _ in range(60):
        forces.append(float(one.step([pull, 0.0, d], TIME / 20, at_rest=True).contact_forces[0]))
        times.append(one.time)
    modulus = 1 + g * np.exp(-np.array(times) / tau)
    wanted = held * (reach - d * modulus) / (reach - d)
    assert np.array(forces) == pytest.approx(wanted, rel=0.01)
    assert forces[0] < 0.92 * forces[-1]  # what is pulled against the plane presses more as the rubber yields


def test_a_small_vibration_decays_as_an_oscillator_with_one_branch():
    """s^2 + w^2 (1 + g s tau / (1 + s tau)) = 0, with the frequency w of the elastic finger."""

    step, window, shift = 2e-4, 400, 100  # of 80 ms, which a first mode passes four times, and 20 ms later

    def root_of(finger, guess: float) -> complex:
        """By the first mode's amplitude in two windows."""
        one, rest = MovingFinger(finger, [0.5, 0.0, AWAY], DENSITY, radius=1.0), finger.evaluate([0.0, 0.0, AWAY])
        tips = np.array([one.step([0.0, 0.0, AWAY], step).tip[1] - rest.tip[1] for _ in range(window + shift)])
        waves = tips * np.exp(-1j * guess * step * np.arange(len(tips)))
        before, after = (np.hanning(window) @ waves[k : k + window] for k in (0, shift))
        return np.log(after / before) / (step * shift) + 1j * guess

    free = root_of(rom.load(), 2 * np.pi * 49.4)
    finger, time = soft((0.3, 3e-3)), 3e-3
    g, tau = relaxing(finger, 0.3, time)
    w = free.imag
    (wanted,) = [one for one in np.roots([tau, 1, w**2 * tau * (1 + g), w**2]) if one.imag > 0]
    found = root_of(finger, wanted.imag)
    assert abs(free.real) < 0.2 and wanted.real < -15
    assert found == pytest.approx(wanted, abs=0.01 * abs(wanted.real))


def test_a_finger_that_is_held_for_an_hour_is_relaxed():
    finger, point = soft((0.2, 0.01), (0.1, 30.0), (0.3, 300.0)), [40.0, 5.0, 0.003]
    one = MovingFinger(finger, [0.0, 0.0, 0.003], DENSITY, radius=0.0)
    first = [one.step(point, 1e-3) for _ in range(100)][-1]
    for length in (0.1, 1.0, *[60.0] * 60):
        state = one.step(point, length, at_rest=True)
        assert state.status == "converged"
    at = finger.evaluate(point)
    assert one.time > 3600 and not state.velocity.any() and state.kinetic_energy == 0.0
    assert first.contact_forces < 0.95 * state.contact_forces
    assert state.tip == pytest.approx(at.tip, abs=1e-7)
    assert state.contact_forces == pytest.approx(at.contact_force, rel=1e-4)


def test_a_similar_finger_creeps_alike():
    tips = []
    for size, modulus in ((1.0, 1.0), (2.0, 0.1)):
        scene = soft((MODULUS, TIME)).rod.scene
        finger = rom.load()
        own = rescaled(scene, modulus, size)
        finger = replace(finger, rod=finger.rod.assembled(own))
        force = 5.0 * modulus * size**2
        one = MovingFinger(finger, [0.0, 0.0, 0.05], DENSITY * 1e-3, radius=0.0)
        states = [one.step([force, 0.0, 0.05], 0.1).tip / size for _ in range(10)]
        tips.append(states[-1])
    assert tips[1] == pytest.approx(tips[0], abs=1e-7)


@pytest.mark.parametrize(
    ("prony", "message"),
    [
        ([], "must be 1 to 8 branches"),
        ([[0.1]], "must be 1 to 8 branches"),
        ([[0.1, 1.0]] * 9, "must be 1 to 8 branches"),
        ("much", "must be 1 to 8 branches"),
        ([[0.1, 0.0]], "must have moduli and times from 1e-09 to 1e"),
        ([[np.nan, 1.0]], "must have moduli and times from 1e-09 to 1e"),
    ],
)
def test_branches_that_are_none_are_refused(prony, message):
    finger = rom.load()
    material = finger.rod.scene["material"] | {"prony": prony}
    changed = replace(finger, rod=finger.rod.assembled(finger.rod.scene | {"material": material}))
    with pytest.raises(ModelError, match=message):
        MovingFinger(changed, [0.0, 0.0, AWAY], DENSITY)
