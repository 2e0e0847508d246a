"""Steps of time: frequencies, order, rest, weight, contact that takes energy, and what is refused."""

import numpy as np
import pytest
from scipy.linalg import eigh, null_space

import rom
from rom.files.checked_file import ModelError
from rom.rod.compiled.touched import touches
from rom.rod.motion.lumps import lumps_of
from rom.rod.motion.moving_finger import MovingFinger

DENSITY, AWAY = 1100.0, 0.03  # [kg/m^3], of the plane [m]


@pytest.fixture(scope="module")
def finger():
    return rom.load()


def moving(finger, point=(0.0, 0.0, AWAY), **more) -> MovingFinger:
    return MovingFinger(finger, point, **({"density": DENSITY} | more))


def frequencies(finger, parts: int) -> np.ndarray:
    return moving(finger, parts=parts).frequencies([0.0, 0.0], 7)


def test_all_mass_but_that_at_the_clamp_is_at_the_sections(finger):
    masses = lumps_of(finger.rod, DENSITY, 7850.0).masses
    side, clamp = 0.010, finger.rod.pieces[0][-1].length
    assert masses.sum() == pytest.approx(side**2 * (DENSITY * (0.049 - clamp / 2) + 7850 * 0.001))


def test_a_few_long_elements_have_the_first_frequencies_of_many(finger):
    first, second, fine = (frequencies(finger, parts)[[0, 3, 6]] for parts in (1, 2, 4))  # in bending towards +y
    assert first / fine == pytest.approx(1, abs=0.02) and first[:2] / fine[:2] == pytest.approx(1, abs=0.004)
    assert second / fine == pytest.approx(1, abs=0.004)


def test_frequencies_are_those_of_the_full_order_model(finger):
    # docker/run python3 -m fingerfem modes, 16 x 5 cells of order 2 [Hz]: bending thrice, each once in every plane
    assert frequencies(finger, 1)[[0, 3, 6]] == pytest.approx([49.46, 286.1, 703.2], rel=0.017)
    assert frequencies(finger, 1)[:2] == pytest.approx([49.46, 49.46], rel=0.002)


def test_frequencies_need_numbers_of_all_tendons(finger):
    with pytest.raises(ModelError, match="in that order"):
        moving(finger).frequencies([1.0])
    assert (np.diff(moving(finger).frequencies([60.0, 40.0], 6)) > 0).all()


def test_tensions_alone_have_the_frequencies_without_objects(finger):
    one = moving(finger)
    assert np.array_equal(one.frequencies([60.0, 40.0], 6), one.frequencies([60.0, 40.0, np.inf], 6))
    assert one.frequencies([60.0, 40.0, AWAY], 6) == pytest.approx(one.frequencies([60.0, 40.0], 6), rel=1e-9)


def test_frequencies_at_first_touch_are_those_of_a_finger_held_at_its_touching_points(finger):
    reach = float(finger.evaluate([20.0, 0.0, np.inf]).touch_distance)
    point, one, plates = [20.0, 0.0, reach - 1e-6], moving(finger), finger.rod.place([20.0, 0.0])
    free = touches(finger.touching, np.array([[20.0, 0.0, np.inf]])).loads[0]
    at = np.array([20.0, 0.0, np.inf])
    mass, compliance = one._stepper_at(at, free).linearised(at, free)
    contacts = finger.contact_forces(point)
    rows = np.zeros((len(contacts), len(mass)))
    assert len(contacts) > 0
    for row, contact in zip(rows, contacts, strict=True):  # velocities of corners along the normal
        arm = (contact.place - plates.centres[-1]) @ plates.rotations[-1]
        normal = contact.normal @ plates.rotations[-1]
        row[-6:] = *normal, *np.cross(arm, normal)
    ways = null_space(rows)
    stiffness = np.linalg.inv((compliance + compliance.T) / 2)
    squares = eigh(ways.T @ stiffness @ ways, ways.T @ mass @ ways, eigvals_only=True)
    assert one.frequencies(point, 6) == pytest.approx(np.sqrt(squares[:6]) / (2 * np.pi), rel=3e-3)


def test_frequencies_about_what_has_no_equilibrium_in_the_domain_are_refused(finger):
    for point in ([150.0, 0.0], [10.0, 0.0, -0.02]):
        with pytest.raises(ModelError, match="parameters must have a stable equilibrium in the domain"):
            moving(finger).frequencies(point)
    sections = len(moving(finger).lumps.masses)
    with pytest.raises(ModelError, match=f"count must be from 1 to {6 * sections}, got {6 * sections + 1}"):
        moving(finger).frequencies([0.0, 0.0], 6 * sections + 1)


@pytest.mark.parametrize(("kicked", "axis", "number"), [([52.0, 0.0], 1, 1), ([50.0, 2.0], 2, 0)])
def test_in_contact_a_small_vibration_has_the_frequency_of_compliance_and_mass(finger, kicked, axis, number):
    point, length = [50.0, 0.0, 0.01], 5e-5
    one = moving(finger, point)
    wanted = one.frequencies(point)[number]
    for k in range(1, 101):  # a pulse of 5 ms
        one.step(point + np.sin(np.pi * k / 100) ** 2 * np.subtract([*kicked, 0.01], point), length)
    states = [one.step(point, length) for _ in range(2000)]
    assert all(state.contact_forces[0] > 0 for state in states)
    tips, times = np.array([state.tip[axis] for state in states]), length * np.arange(2000)
    tried = wanted * np.linspace(0.95, 1.05, 201)
    spectrum = np.abs(np.exp(-2j * np.pi * np.outer(tried, times)) @ (np.hanning(2000) * (tips - tips.mean())))
    assert tried[np.argmax(spectrum)] == pytest.approx(wanted, rel=0.01)


def test_a_small_vibration_has_the_frequency_of_compliance_and_mass(finger):
    wanted, length = frequencies(finger, 1)[0], 1e-4
    one = moving(finger, (0.5, 0.0, AWAY), radius=1.0, parts=1)
    tips = np.array([one.step([0.0, 0.0, AWAY], length).tip[1] for _ in range(1000)])
    crossings = np.flatnonzero(np.diff(np.sign(tips - tips.mean())) > 0)
    assert len(crossings) == 5
    found = (len(crossings) - 1) / ((crossings[-1] - crossings[0]) * length)
    assert found == pytest.approx(wanted, rel=0.01)


def test_it_comes_to_rest_where_it_rests(finger):
    for d in (AWAY, 0.003):
        one = moving(finger, (0.0, 0.0, AWAY), radius=0.0)
        for point in ([40.0, 5.0, AWAY], [40.0, 5.0, d], [40.0, 5.0, d], [40.0, 5.0, d]):
            for _ in range(20):
                state = one.step(point, 0.1)
        at = one.model.evaluate([40.0, 5.0, d])
        assert state.status == "converged"
        assert state.tip == pytest.approx(at.tip, abs=1e-8)
        assert state.contact_forces == pytest.approx(at.contact_force, abs=1e-4)
        assert np.abs(state.velocity).max() < 1e-6


def test_the_error_falls_with_the_square_of_the_step(finger):
    def tip(length: float) -> np.ndarray:
        one, count = moving(finger, parts=1), round(0.01 / length)
        for k in range(1, count + 1):
            pull = 20 * np.sin(0.5 * np.pi * k / count) ** 2
            state = one.step([pull, 0.3 * pull, AWAY], length)
        return state.tip

    coarse, fine, finest = (tip(length) for length in (5e-4, 2.5e-4, 2.5e-5))
    ratio = np.linalg.norm(coarse - finest) / np.linalg.norm(fine - finest)
    assert 3 < ratio < 5.5


def test_contact_takes_energy_and_never_gives_any(finger):
    one = moving(finger, (0.0, 0.0, 0.001), parts=1)
    energies, forces = [], []
    for _ in range(480):
        state = one.step([8.0, 0.0, 0.001], 5e-4)  # swings against the plane, and rebounds by its own elasticity
        assert state.status == "converged" and (state.contact_forces >= 0).all()
        energies.append(state.kinetic_energy)
        forces.append(float(state.contact_forces[0]))
    means = np.array(energies).reshape(8, -1).mean(axis=1)
    assert (np.diff(means) < 0).all() and means[-1] < 0.4 * means[0]
    assert 0.0 in forces[int(np.argmax(np.array(forces) > 0)) :]
    static = float(finger.evaluate([8.0, 0.0, 0.001]).contact_force)
    assert np.mean(forces) == pytest.approx(static, rel=0.02)


def test_energy_of_a_free_vibration_stays_and_with_damping_never_grows(finger):
    for radius in (1.0, 0.0):
        one = moving(finger, (5.0, 0.0, AWAY), radius=radius, parts=1)
        energies = np.array([one.step([0.0, 0.0, AWAY], 1e-3).kinetic_energy for _ in range(1500)])
        windows = energies.reshape(10, -1).max(axis=1)
        assert windows[-1] < windows[0] * 1.02
        assert (windows[-1] > 0.5 * windows[0]) == (radius == 1.0)


def test_what_is_beyond_the_training_is_marked(finger):
    one = moving(finger, parts=1)
    assert one.step([150.0, 0.0, AWAY], 1e-3).status == "out_of_domain"


def test_what_a_caller_does_to_a_state_leaves_the_finger_as_it_was(finger):
    one, other = moving(finger, parts=1), moving(finger, parts=1)
    state, same = (own.step([20.0, 0.0, AWAY], 1e-3) for own in (one, other))
    for changed in (state.tip, state.velocity, state.contact_forces):
        changed[:] = 9.0
    assert np.array_equal(one.step([20.0, 0.0, AWAY], 1e-3).tip, other.step([20.0, 0.0, AWAY], 1e-3).tip)
    assert not np.array_equal(same.velocity, state.velocity)


def test_a_step_that_finds_no_answer_leaves_all_as_it_was(finger):
    one, other = moving(finger), moving(finger)
    failed = one.step([10.0, 0.0, -0.02], 1e-3)  # the plane is in the finger at once
    assert failed.status in ("no_equilibrium", "out_of_domain")
    if failed.status == "no_equilibrium":
        assert failed.time == 0.0 and np.isnan(failed.tip).all()
        assert one.step([1.0, 0.0, AWAY], 1e-3).tip == pytest.approx(other.step([1.0, 0.0, AWAY], 1e-3).tip, abs=1e-15)


def test_an_object_may_come_from_away_and_go_there(finger):
    one = moving(finger, (5.0, 0.0, np.inf))
    states = [one.step([5.0, 0.0, d], 1e-3) for d in (np.inf, 0.02, np.inf)]
    assert [state.status for state in states] == ["converged"] * 3 and np.isfinite(
        [state.tip for state in states]
    ).all()
    assert one.step([5.0, 0.0, 1.0], 1e-3).status == "out_of_domain"  # farther than it may be


@pytest.mark.parametrize(
    ("point", "length", "message"),
    [
        ([np.nan, 0.0, AWAY], 1e-3, "must be numbers F1, F2, d, got"),
        ([1.0, 0.0, np.nan], 1e-3, "must be numbers F1, F2, d, got"),
        ([np.inf, 0.0, AWAY], 1e-3, "must be numbers F1, F2, d, got"),
        ([1.0, 0.0], 1e-3, "in that order"),
        ([1.0, 0.0, AWAY], 0.0, "length must be at least 1e-06 s"),
        ([1.0, 0.0, AWAY], -1e-3, "length must be at least 1e-06 s"),
        ([1.0, 0.0, AWAY], np.nan, "length must be at least 1e-06 s"),
        ([1.0, 0.0, AWAY], np.inf, "length must be at least 1e-06 s"),
    ],
)
def test_a_step_of_no_numbers_or_no_length_is_refused(finger, point, length, message):
    with pytest.raises(ModelError, match=message):
        moving(finger).step(point, length)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"density": None}, "density must be given"),
        ({"density": -1.0}, "density must be above 0"),
        ({"density": 0.0}, "density must be above 0"),
        ({"density": np.inf}, "density must be above 0 and at most"),
        ({"plate_density": np.nan}, "plate_density must be above 0"),
        ({"radius": np.nan}, "radius must be from 0 to 1"),
        ({"parts": 0}, "parts must be an integer of at least 1, got 0"),
        ({"point": [1.0, 0.0]}, "in that order"),
        ({"radius": 1.1}, "radius must be from 0 to 1"),
        ({"point": [300.0, 0.0, AWAY]}, "parameters must be where the finger can rest"),
        ({"parts": 6}, "must have fewer sections, got 20"),
    ],
)
def test_what_cannot_move_is_refused(finger, more, message):
    with pytest.raises(ModelError, match=message):
        moving(finger, **more)
