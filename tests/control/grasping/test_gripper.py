"""Three fingers around an object of unknown position."""

import numpy as np
import pytest

from control import Flaws, GraspOptions, Gripper, SimulatedPlant


def close(table, centre, radius, force=1.0, flaws=None, **options):
    gripper = Gripper(table)
    plants = [SimulatedPlant(table, d, flaws, seed=k) for k, d in enumerate(gripper.distances(centre, radius))]
    return gripper.grasp(force, plants, GraspOptions(**options))


@pytest.mark.parametrize("centre", [(0.0, 0.0), (0.004, 0.002), (-0.003, 0.003), (0.0, -0.005)], ids=str)
def test_the_object_is_found_and_held_wherever_it_is(table, centre):
    grasp = close(table, centre, 0.012)
    assert grasp.converged
    assert grasp.contact_forces == pytest.approx(np.ones(3), rel=0.005)
    assert grasp.centre == pytest.approx(centre, abs=1e-6)
    assert grasp.radius == pytest.approx(0.012, abs=1e-6)


def test_no_pull_ever_crushes_the_object(table):
    grasp = close(table, (0.002, 0.001), 0.012, approach_step=1.0)
    assert max(pull.contact_force for pull in grasp.history) < 1.1


def test_a_noisy_sensor_still_holds(table):
    grasp = close(table, (0.001, 0.001), 0.012, flaws=Flaws(noise=0.02), noise=0.02, tolerance=0.03)
    assert grasp.converged
    assert grasp.contact_forces == pytest.approx(np.ones(3), rel=0.03)


def test_in_a_dead_band_nothing_is_corrected(table):
    """The fingers press a tenth harder than the table: a dead band leaves it so, without one it is corrected."""
    options = {"flaws": Flaws(force_error=0.1), "squeeze_steps": 10, "approach_step": 0.5, "tolerance": 0.15}
    left, corrected = (close(table, (0.0, 0.0), 0.012, dead_band=band, **options) for band in (0.15, 0.0))
    assert left.converged and corrected.converged
    held = [pull.tensions for pull in left.history if pull.finger == 0 and pull.stage == "hold"]
    assert all(tensions == held[0] for tensions in held[1:])
    assert np.abs(left.contact_forces - 1).max() > 5 * np.abs(corrected.contact_forces - 1).max()
    assert np.abs(left.contact_forces - 1).max() < 0.15


class Sticking(SimulatedPlant):
    """It keeps the contact of its highest tension, and gets longer with less: it then presses harder."""

    highest = np.zeros(2)

    def pull(self, tensions):
        self.highest = np.maximum(self.highest, tensions)
        return super().pull(self.highest) + 0.1 * float(self.highest[0] - tensions[0])


def test_a_finger_that_sticks_does_not_press_harder_and_harder(table):
    """A smaller target is met by a finger that slides; of one that sticks the tensions stay, and that is a status."""
    options = GraspOptions(squeeze_steps=10, approach_step=0.5, tolerance=0.15, dead_band=0.15)
    for plant, status in ((SimulatedPlant(table, 0.01), "converged"), (Sticking(table, 0.01), "sticks")):
        grip = Gripper(table).grips(1.0, options)[0]
        felt = []
        for target in (1.0, 0.7, 1.2):
            grip.target = target
            for _ in range(300):
                felt.append(plant.pull(grip.tensions))
                grip.step(felt[-1])
            assert grip.status == (status if target == 0.7 else "converged")
            assert ("less tension presses harder" in grip.reason) == (grip.status == "sticks")
        assert felt[599] == felt[400] and max(felt[300:600]) < 1.2 * felt[299]
        assert felt[-1] == pytest.approx(1.2, rel=0.15)
    grip.confined, grip.target, before = False, 0.7, grip.tensions[0]  # a free object moves away
    for _ in range(20):
        grip.step(plant.pull(grip.tensions))
    assert grip.tensions[0] < before - 3 and grip.status == "moving"


def test_a_finger_that_stuck_lowers_its_tension_at_another_object(table):
    options = GraspOptions(approach_step=3.0, squeeze_steps=10, tolerance=0.15, dead_band=0.15)
    grip, stuck, other = Gripper(table).grips(1.0, options)[0], Sticking(table, 0.01), SimulatedPlant(table, 0.008)
    for target in (1.0, 0.7):
        grip.target = target
        for _ in range(200):
            grip.step(stuck.pull(grip.tensions))
    assert grip.status == "sticks"
    grip.step(0.0)  # the object is taken away
    felt = [reading for _ in range(200) for reading in [other.pull(grip.tensions)] if grip.step(reading).any()]
    assert max(felt) > 1.1 and felt[-1] == pytest.approx(0.7, rel=0.15) and grip.status == "converged"


@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_a_finger_that_an_object_approaches_does_not_stick(table, noise):
    options = GraspOptions(squeeze_steps=10, approach_step=0.5, tolerance=0.15, dead_band=0.15, noise=noise)
    grip, plant = Gripper(table).grips(1.0, options)[0], SimulatedPlant(table, 0.012, Flaws(noise=noise))
    forces, tensions = [], []
    for k in range(900):
        plant._distance -= 5e-6 * (k >= 300)
        felt = plant.pull(grip.tensions)
        grip.step(felt)
        forces.append(plant.contact_force)
        tensions.append(grip.tensions[0])
    assert grip.status == "converged" and tensions[-1] < tensions[299] - 4
    assert max(forces[300:]) < 1.25


def test_readings_are_believed_no_faster_than_a_finger_settles(table):
    options = GraspOptions(period=0.005, settling=0.05)
    assert options.gain(1.0) == pytest.approx(0.1) and GraspOptions(period=0.005).gain(1.0) == 1.0
    assert close(table, (0.001, 0.0), 0.012, period=0.005, settling=0.05).converged
    for wrong in ({"settling": -1.0}, {"dead_band": np.nan}):
        with pytest.raises(ValueError, match="must be at least 0"):
            GraspOptions(**wrong)
    with pytest.raises(ValueError, match=r"dead_band must be at most the tolerance, 0\.005, got 0\.15"):
        GraspOptions(dead_band=0.15)


def test_a_touch_that_was_noise_is_not_taken_for_the_object(table):
    class Nervous(SimulatedPlant):
        def pull(self, tensions):
            return super().pull(tensions) + (0.2 if tensions[0] < 5 else 0.0)

    gripper = Gripper(table)
    plants = [Nervous(table, d) for d in gripper.distances((0.001, 0.0), 0.012)]
    grasp = gripper.grasp(1.0, plants)
    assert grasp.converged and grasp.contact_forces == pytest.approx(np.ones(3), rel=0.005)


def test_a_finger_does_not_move_by_a_dead_sensor(table):
    class Dead:
        def pull(self, tensions):
            return float("nan")

    grasp = Gripper(table).grasp(1.0, [Dead(), SimulatedPlant(table, 0.01), SimulatedPlant(table, 0.01)])
    assert grasp.status == ["sensor_failed", "converged", "converged"]
    assert all(pull.tensions == [0.0, 0.0] for pull in grasp.history if pull.finger == 0)


@pytest.mark.parametrize("force", [0.0, -1.0, np.nan, np.inf])
def test_a_force_that_is_none_is_refused(table, force):
    with pytest.raises(ValueError, match="contact_force must be above 0 N"):
        close(table, (0.0, 0.0), 0.012, force=force)


def test_the_object_is_not_placed_by_a_finger_that_does_not_hold(table):
    gripper = Gripper(table)
    plants = [SimulatedPlant(table, d) for d in (0.010, 0.012, 0.031)]
    grasp = gripper.grasp(1.0, plants)
    assert grasp.status == ["converged", "converged", "no_contact"]
    assert np.isnan(grasp.centre).all() and np.isnan(grasp.radius)


def test_an_empty_gripper_says_no_contact(table):
    grasp = Gripper(table).grasp(1.0, [SimulatedPlant(table, 0.031)] * 3)
    assert grasp.status == ["no_contact"] * 3 and not grasp.converged
    assert np.isnan(grasp.distances).all() and np.isnan(grasp.centre).all()


def test_a_force_beyond_the_tendons_is_said_to_be_unreachable(table):
    grasp = close(table, (0.0, 0.0), 0.012, force=200.0)
    assert grasp.status == ["unreachable"] * 3


def test_one_plant_a_finger(table):
    with pytest.raises(ValueError, match="one for each of the 3 fingers, got 1"):
        Gripper(table).grasp(1.0, [SimulatedPlant(table, 0.01)])


def test_a_simulated_finger_does_not_leave_the_trained_box(table):
    with pytest.raises(ValueError, match="trained box"):
        SimulatedPlant(table, 0.01).pull([200.0, 0.0])
