"""Energy of a finger that vibrates in contact never grows without input; an impact has one impulse at every step."""

from dataclasses import replace

import numpy as np
import pytest

import rom
from rom import Cylinder, Plane, Sphere, TouchedSegment
from rom.rod.motion.moving_finger import MovingFinger

DENSITY, TENSION, RADIUS = 1100.0, 20.0, 0.008  # [kg/m^3], [N], of balls and cylinders [m]
SIDE = {"plate": (1.0, 1.0), "rubber": (0.6, -1.0)}  # where a plane is [-] along the finger, and on which side
WINDOW, WINDOWS = 0.05, 5  # means of kinetic energy over such times [s]; their number
GROWTH = 0.03  # of a mean over the first that phases of several modes and the tolerance of steps leave [-]


@pytest.fixture(scope="module")
def bundled() -> TouchedSegment:
    return TouchedSegment.load()


def pressed(bundled: TouchedSegment, shape: str, on: str) -> tuple[TouchedSegment, float]:
    """An object at the tip plate or at the rubber, and d where it presses with 1 N."""
    along, side = SIDE[on]
    found = bundled.rod.sections([TENSION, 0.0], at=[along * bundled.rod.rest[0]])
    out = np.array([0.0, 1.0, 0.0])
    if on == "rubber":
        out = found.rotations[0] @ [0.0, side if shape == "plane" else 1.0, 0.0]
    where = {"direction": tuple(out), "distances": (-0.1, 0.1)}
    centre = tuple(found.centres[0] + (0.0 if shape == "plane" else RADIUS) * out)
    obstacle = {
        "plane": lambda: Plane(centre=centre, normal=tuple(-out), **where),
        "ball": lambda: Sphere(centre=centre, radius=RADIUS, **where),
        "cylinder": lambda: Cylinder(centre=centre, radius=RADIUS, axis=(0.0, 0.0, 1.0), **where),
    }[shape]()
    model = replace(bundled, obstacle=obstacle)
    near = float(model.outputs([[TENSION, 0.0, np.inf]])[0, 4])
    far = near - 2e-3
    for _ in range(14):
        middle = (near + far) / 2
        less = model.outputs([[TENSION, 0.0, middle]])[0, 3] < 1.0
        near, far = (middle, far) if less else (near, middle)
    return model, far


@pytest.mark.parametrize("radius", [1.0, 0.8])
@pytest.mark.parametrize("length", [1e-3, 2.5e-4, 1e-4])
@pytest.mark.parametrize("on", SIDE)
@pytest.mark.parametrize("shape", ["plane", "ball", "cylinder"])
def test_a_vibration_in_lasting_contact_never_gains_energy(bundled, shape, on, length, radius):
    model, d = pressed(bundled, shape, on)
    assert any(one.rubber for one in model.contact_forces([TENSION, 0.0, d])) == (on == "rubber")
    finger = MovingFinger(model, [TENSION, 0.0, np.inf], DENSITY, radius=radius)
    for share in np.linspace(0.0, 2e-3, 9)[1:]:
        finger.step([TENSION, 0.0, max(d, d + 2e-3 - share)], 0.05, at_rest=True)
    point = [TENSION + 0.5, 0.2, d]
    finger.step(point, 1e-5)  # loads jump, and stay
    states = [finger.step(point, length) for _ in range(round(WINDOWS * WINDOW / length))]
    assert all(state.status == "converged" for state in states)
    lasts = all(state.contact_forces[0] > 0 for state in states)
    means = np.array([state.kinetic_energy for state in states]).reshape(WINDOWS, -1).mean(axis=1)
    assert means[0] > 1e-7 and (np.maximum.accumulate(means) < (1 + GROWTH) * means[0]).all()
    if radius < 1:
        assert (np.diff(means) < GROWTH * means[:-1]).all() and means[-1] < 0.95 * means[0]
    if radius == 1 and on == "plate" and lasts:  # nothing takes any
        assert means[-1] > (1 - 2 * GROWTH) * means[0]


def test_a_long_vibration_on_rubber_without_damping_keeps_its_energy(bundled):
    """A ball presses deep, so that no point leaves it: 4 s of steps of 2 ms, of which modes have a tenth to a half."""
    tensions, depth = [40.0, 30.0], 1e-3
    section = bundled.rod.sections(tensions, at=[0.4 * bundled.rod.rest[0]])
    out = section.rotations[0] @ [0.0, 0.0, -1.0]
    centre = tuple(section.centres[0] + (bundled.rod.half_lengths[1] + RADIUS) * out)
    ball = Sphere(centre=centre, radius=RADIUS, direction=tuple(out), distances=(-0.1, 0.1))
    finger = MovingFinger(replace(bundled, obstacle=ball), [*tensions, np.inf], DENSITY, radius=1.0)
    for d in np.linspace(depth, -depth, 9):
        finger.step([*tensions, d], 0.05, at_rest=True)
    point = [40.3, 29.7, -depth]
    finger.step(point, 1e-5)
    states = [finger.step(point, 2e-3) for _ in range(2000)]
    assert all(state.status == "converged" and state.contact_forces[0] > 1.0 for state in states)
    means = np.array([state.kinetic_energy for state in states]).reshape(10, -1).mean(axis=1)
    assert means[0] > 1e-7 and means == pytest.approx(means[0], rel=GROWTH)


@pytest.mark.parametrize("radius", [1.0, 0.8])
@pytest.mark.parametrize(("shape", "on"), [("plane", "plate"), ("cylinder", "plate"), ("ball", "rubber")])
def test_rebounds_take_energy(bundled, shape, on, radius):
    model, d = pressed(bundled, shape, on)
    finger = MovingFinger(model, [TENSION - 10, 0.0, d], DENSITY, radius=radius)
    states = [finger.step([TENSION, 0.5, d], 1e-3) for _ in range(500)]
    assert all(state.status == "converged" for state in states)
    forces = np.array([state.contact_forces[0] for state in states])
    assert (forces >= 0).all() and 0.0 in forces[int(np.argmax(forces > 0)) :]
    means = np.array([state.kinetic_energy for state in states]).reshape(5, -1).mean(axis=1)
    assert (np.maximum.accumulate(means) < (1 + GROWTH) * means[0]).all() and means[-1] < 0.8 * means[0]


@pytest.mark.parametrize("radius", [1.0, 0.8])
@pytest.mark.parametrize("length", [2e-3, 1e-4])
@pytest.mark.parametrize("on", SIDE)
@pytest.mark.parametrize("shape", ["plane", "ball"])
def test_what_rests_in_contact_stays_at_rest(bundled, shape, on, length, radius):
    model, d = pressed(bundled, shape, on)
    point = [TENSION, 0.0, d]
    force = float(model.evaluate(point).contact_force)
    began = MovingFinger(model, point, DENSITY, radius=radius)
    came = MovingFinger(model, [TENSION, 0.0, np.inf], DENSITY, radius=radius)
    for ahead in np.linspace(2e-3, 0.0, 9):
        came.step([TENSION, 0.0, d + ahead], 0.05, at_rest=True)
    for finger in (began, came):
        states = [finger.step(point, length) for _ in range(20)]
        assert max(state.kinetic_energy for state in states) < 1e-16
        assert [state.contact_forces[0] for state in states] == pytest.approx([force] * 20, rel=1e-5)


@pytest.mark.parametrize("shape", ["plane", "ball", "cylinder"])
def test_on_rubber_it_comes_to_rest_where_it_rests(bundled, shape):
    model, d = pressed(bundled, shape, "rubber")
    finger = MovingFinger(model, [TENSION, 0.0, np.inf], DENSITY)
    for ahead in [*np.linspace(2e-3, 0.0, 9), 0.0, 0.0]:
        state = finger.step([TENSION, 0.0, d + ahead], 0.05, at_rest=True)
    at = model.evaluate([TENSION, 0.0, d])
    assert state.status == "converged" and state.tip == pytest.approx(at.tip, abs=1e-9)
    assert state.contact_forces[0] == pytest.approx(float(at.contact_force), rel=1e-6)


def test_the_impulse_of_an_impact_does_not_depend_on_the_step():
    found = []
    for length in (5e-4, 2.5e-4, 1.25e-4):
        finger = MovingFinger(rom.load(), [0.0, 0.0, 0.004], DENSITY)
        forces = [
            finger.step([min(8.0, 800.0 * k * length), 0.0, 0.004], length).contact_forces[0]
            for k in range(1, round(0.03 / length) + 1)
        ]
        begun = int(np.argmax(np.array(forces) > 0))
        assert forces[begun] > 0
        found.append(length * np.sum(forces[begun : begun + round(2e-3 / length)]))
    assert found[:2] == pytest.approx([found[-1]] * 2, rel=0.1)


def test_no_contact_that_begins_beside_another_has_more_impulse_than_the_finger_has_momentum():
    """A round plate touches a plane at two points, which are close to each other and begin at different steps."""
    model = TouchedSegment.load("round")

    def tensions(time: float) -> np.ndarray:
        turn = np.sin(6 * np.pi * np.array([3.0, 1.0, 1.0]) * time)
        return np.array([1.5 + 0.3 * turn[0], 1.0 + turn[1], 0.5, 1.0 - turn[2]])

    d, length = float(model.outputs([[*tensions(0.0), np.inf]])[0, 4]), 1e-3
    finger = MovingFinger(model, [*tensions(0.0), d + 2e-4])
    states = [finger.step([*tensions(k * length), d], length) for k in range(1, 151)]
    forces = np.array([state.contact_forces[0] for state in states])
    fastest = max(float(np.linalg.norm(state.velocity)) for state in states)
    assert np.count_nonzero(forces > 0) > 30
    assert (forces >= 0).all() and forces.max() * length < finger.lumps.masses.sum() * fastest
