"""A control loop that goes on, holds and reports whatever its plants do."""

import numpy as np
import pytest

import rom
from control import Flaws, GraspOptions, Gripper, Limits, MovingPlant, SimulatedPlant
from control.loop import run
from control.plant import Dead, Slipping

OPTIONS = GraspOptions(approach_step=0.3, squeeze_steps=50, tolerance=0.03, noise=0.01)
FLAWS = Flaws(noise=0.01, resolution=0.005, delay=3, force_error=0.05)
SETTLED, END = 500, 900  # periods


@pytest.fixture(scope="module")
def gripper(table):
    return Gripper(table, limits=Limits(rate=2000.0))


def plants_of(table, flaws=FLAWS):
    return [SimulatedPlant(table, d, flaws, seed=k) for k, d in enumerate((0.010, 0.012, 0.008))]


def loop(gripper, plants, periods=END, targets=None, force=1.0):
    return run(gripper.grips(force, OPTIONS), plants, periods, targets)


def true_forces(plants):
    return np.array([plant.contact_force for plant in plants])


def test_with_noise_delay_rounding_and_an_error_of_the_model_it_holds(table, gripper):
    plants = plants_of(table)
    report = loop(gripper, plants)
    assert report.status == ["converged"] * 3
    assert true_forces(plants) == pytest.approx(np.ones(3), rel=0.03)
    assert report.felt.max() < 1.1  # never much harder on the way
    assert report.periods == END and report.p50_us <= report.p99_us <= report.p999_us <= report.max_us


def test_no_tension_changes_faster_than_its_motor_can(table, gripper):
    report = loop(gripper, plants_of(table), targets=lambda k: [3.0] * 3 if k == SETTLED else None)
    assert np.abs(np.diff(report.tensions, axis=0)).max() <= 2000.0 * OPTIONS.period + 1e-9


def test_a_target_that_jumps_is_followed_and_one_that_is_none_refused(table, gripper):
    plants = plants_of(table)
    jumps = {SETTLED: [2.0, 0.5, 1.5], SETTLED + 100: [np.nan, -1.0, np.inf]}
    report = loop(gripper, plants, targets=jumps.get)
    assert true_forces(plants) == pytest.approx([2.0, 0.5, 1.5], rel=0.05)
    assert [event for *_, event in report.events].count("target refused") == 3


def test_a_tendon_that_slips_is_noticed_and_pulled_harder(table, gripper):
    plants = plants_of(table)
    report = loop(gripper, [Slipping(plants[0], 0, 0.8, SETTLED), *plants[1:]])
    assert any(k > SETTLED and i == 0 and event in ("surprise", "lost") for k, i, event in report.events)
    assert report.tensions[-1, 0, 0] > 1.1 * report.tensions[SETTLED - 1, 0, 0]
    assert true_forces(plants) == pytest.approx(np.ones(3), rel=0.05)


def test_a_tendon_that_breaks_does_not_make_its_finger_pull_on_and_on(table, gripper):
    plants = plants_of(table)
    report = loop(gripper, [Slipping(plants[0], 0, 0.0, SETTLED), *plants[1:]])
    assert report.status == ["lost_contact", "converged", "converged"]
    assert report.tensions[:, 0].max() <= 1.3 * report.tensions[SETTLED - 1, 0].max()


class Stale(Dead):
    """A sensor that repeats its last reading, and says how old it is."""

    felt = age = 0.0

    def pull(self, tensions):
        felt = super().pull(tensions)
        self.felt, self.age = (self.felt, self.age + 1e-3) if np.isnan(felt) else (felt, self._plant.age)
        return self.felt


@pytest.mark.parametrize("fault", [Dead, Stale])
def test_without_readings_the_tensions_stay_and_it_goes_on_when_they_come_back(table, gripper, fault):
    plants = plants_of(table)
    report = loop(gripper, [fault(plants[0], SETTLED, SETTLED + 200), *plants[1:]])
    blind = report.tensions[SETTLED + OPTIONS.patience + 1 : SETTLED + 200, 0]
    assert np.ptp(blind, axis=0).max() == 0
    assert [event for _, i, event in report.events if i == 0 and "touch" not in event] == ["blind", "sees again"]
    assert report.status == ["converged"] * 3
    assert true_forces(plants) == pytest.approx(np.ones(3), rel=0.05)


def test_a_sensor_that_stays_dead_is_reported_and_the_others_hold(table, gripper):
    plants = plants_of(table)
    report = loop(gripper, [Dead(plants[0], SETTLED), *plants[1:]])
    assert report.status == ["sensor_failed", "converged", "converged"]
    assert true_forces(plants)[0] == pytest.approx(1.0, rel=0.05)


def test_a_plant_that_raises_has_given_no_reading(table, gripper):
    class Unplugged(SimulatedPlant):
        pulls = 0

        def pull(self, tensions):
            self.pulls += 1
            if self.pulls > SETTLED:
                raise OSError("unplugged")
            return super().pull(tensions)

    plants = plants_of(table)
    report = loop(gripper, [Unplugged(table, 0.010, FLAWS), *plants[1:]])
    assert report.unread == END - SETTLED
    assert report.status == ["sensor_failed", "converged", "converged"]


def test_in_real_time_it_keeps_its_rate(table, gripper):
    from time import perf_counter

    begun = perf_counter()
    report = run(gripper.grips(1.0, OPTIONS), plants_of(table), 50, real_time=True)
    assert perf_counter() - begun >= 50 * OPTIONS.period
    assert report.rate == pytest.approx(1000.0) and 0 <= report.missed <= 50


def test_wrong_numbers_are_refused(table, gripper):
    with pytest.raises(ValueError, match="one for each of 3 fingers, got 1"):
        run(gripper.grips(1.0, OPTIONS), plants_of(table)[:1], 10)
    with pytest.raises(ValueError, match="periods must be an integer of at least 1, got 0"):
        run(gripper.grips(1.0, OPTIONS), plants_of(table), 0)
    moving = [MovingPlant(rom.load(), 0.01, 1100.0, Flaws(period=2e-3)) for _ in range(3)]
    with pytest.raises(ValueError, match=r"plants must have the controllers' period of 0\.001 s, got 0\.002 s"):
        run(gripper.grips(1.0, OPTIONS), moving, 10)
    with pytest.raises(ValueError, match="path must have a row more than the 10 periods, got 10"):
        loop(gripper, plants_of(table), 10).errors(np.zeros((10, 2)))
    with pytest.raises(ValueError, match="approach_step must be above 0, got 0"):
        GraspOptions(approach_step=0)
    with pytest.raises(ValueError, match=r"limits.rate must be above 0 N/s, got 0"):
        Gripper(table, limits=Limits(rate=0.0))


# -- found by an adversary -------------------------------------------------------------------------------------------


class Replaying(SimulatedPlant):
    """A plant whose reading and age are changed from a pull on."""

    def __init__(self, table, distance, begin, change):
        super().__init__(table, distance)
        self._begin, self._change, self._count = begin, change, 0

    def pull(self, tensions):
        felt, self._count = super().pull(tensions), self._count + 1
        return felt if self._count <= self._begin else self._change(self, felt)


def one(table, plant, periods=END, targets=None, options=OPTIONS, force=1.0):
    gripper = Gripper(table, fingers=1, limits=Limits(rate=500.0))
    return run(gripper.grips(force, options), [plant], periods, targets)


def test_a_sensor_that_sticks_at_a_likely_value_does_not_pull_its_finger_to_the_limit(table):
    report = one(table, Replaying(table, 0.010, SETTLED, lambda plant, felt: 0.5), 2000)
    assert report.status == ["sensor_failed"] and report.events[-1][2] == "does not answer"
    assert report.tensions[-1].max() <= 1.6 * report.tensions[SETTLED - 1].max()


def test_what_is_lost_while_the_target_changes_is_not_sought_up_to_the_limit(table):
    plant = Replaying(table, 0.010, SETTLED, lambda plant, felt: 0.0)
    report = one(table, plant, 2000, lambda k: [1.5] if k == SETTLED - 1 else None)
    assert report.status == ["lost_contact"]
    assert report.tensions.max() <= 1.3 * report.tensions[SETTLED + 10].max()


def test_a_target_that_changes_always_is_followed_and_held(table):
    plant = SimulatedPlant(table, 0.010)
    report = one(table, plant, 1500, lambda k: [1 + 0.2 * np.sin(k / 100)])
    assert report.status == ["converged"]
    assert plant.contact_force == pytest.approx(1 + 0.2 * np.sin(14.99), abs=0.02)


@pytest.mark.parametrize("age", [-0.5, -1e-3, 1e308, np.inf, np.nan])
def test_an_age_that_is_none_stops_nothing(table, age):
    def old(plant, felt):
        plant.age = age
        return felt

    report = one(table, Replaying(table, 0.010, SETTLED, old))
    assert report.status == ["converged" if age < 0 else "sensor_failed"]
    assert np.ptp(report.tensions[SETTLED:], axis=0).max() < 1e-6


def test_a_target_that_does_not_differ_from_no_contact_is_refused(table):
    gripper = Gripper(table)
    with pytest.raises(ValueError, match=r"contact_force must be above 0\.065 N to differ from no contact, got 0\.04"):
        gripper.grips(0.04)
    with pytest.raises(ValueError, match=r"must be above 1\.17 N"):
        gripper.grips(0.5, GraspOptions(noise=0.3))


@pytest.mark.parametrize("name", ["feel", "noise", "tolerance", "approach_step"])
def test_options_without_end_are_refused(name):
    with pytest.raises(ValueError, match=f"{name} must be"):
        GraspOptions(**{name: np.inf})
