"""Fingers of a simulation as plants: whose turn it is in a period, and what their sensors say when."""

from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("mujoco")

from control import Flaws
from control.mujoco.plant import MujocoPlant, plants

PERIOD = 0.012


class Clock:
    """A simulation of fingers whose contact force is the time, in steps of 1 ms; the k-th is 10 k N stronger."""

    def __init__(self, count: int):
        self.time, self.fingers, self.model = (
            0.0,
            ["finger"] * count,
            SimpleNamespace(opt=SimpleNamespace(timestep=1e-3)),
        )
        self.pulled: list[tuple[int, float, tuple]] = []

    def pull(self, finger, tensions):
        self.pulled.append((finger, round(self.time, 6), tuple(tensions)))

    def advance(self, time):
        self.time = max(self.time, time)

    def contact_forces(self):
        return self.time + 10.0 * np.arange(len(self.fingers))


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 0, 1), (1, 1, 1)])
def test_every_finger_s_share_of_a_period_ends_where_it_stands_in_their_row(order):
    clock = Clock(3)
    hand, ends = plants(clock, PERIOD), []
    for _ in range(4):
        for finger in order:
            hand[finger].pull((1.0, 0.0))
            ends.append((finger, clock.time))
    if order == (1, 1, 1):  # alone it takes a whole period each time
        assert np.diff([time for _, time in ends]) == pytest.approx(np.full(11, PERIOD))
        return
    for finger in range(3):
        times = [time for one, time in ends if one == finger]
        assert np.all(np.diff(times) > 0) and times[-1] - times[0] == pytest.approx(3 * PERIOD)
    if order == (0, 1, 2):
        assert [time for _, time in ends] == pytest.approx(PERIOD / 3 * np.arange(1, 13))
    assert clock.pulled[0] == (order[0], 0.0, (1.0, 0.0))


def test_a_late_sensor_has_the_force_of_so_many_periods_ago_and_says_its_age():
    (plant,) = plants(Clock(1), PERIOD, Flaws(delay=3, period=99.0))
    felt = [plant.pull((0.0,)) for _ in range(8)]
    assert felt[3:] == pytest.approx(PERIOD * np.arange(1, 6)) and plant.age == pytest.approx(3 * PERIOD)
    assert plant.contact_force == pytest.approx(8 * PERIOD)


def test_time_that_goes_on_or_begins_anew_without_the_finger_is_no_debt():
    clock = Clock(1)
    (plant,) = plants(clock, PERIOD)
    for begun in (0.0, 50.5 * PERIOD, 0.25 * PERIOD):
        clock.time = begun
        plant.pull((0.0,))
        assert clock.time == pytest.approx(PERIOD * (int(begun / PERIOD) + 1))
        plant.pull((0.0,))
        assert clock.time == pytest.approx(PERIOD * (int(begun / PERIOD) + 2))


def test_noise_is_each_finger_s_own_and_the_same_for_a_seed():
    felt = [
        [one.pull((0.0,)) - one.contact_force for one in plants(Clock(2), PERIOD, Flaws(noise=0.1), seed)]
        for seed in (5, 5, 6)
    ]
    assert felt[0] == felt[1] and felt[0][0] != felt[0][1] and felt[0][1] == pytest.approx(felt[2][0])
    mixed = plants(Clock(2), PERIOD, [None, Flaws(noise=0.1)])
    assert [one.pull((0.0,)) == one.contact_force for one in mixed] == [True, False]


def test_a_period_shorter_than_a_step_is_refused():
    MujocoPlant(Clock(1), 0, period=1e-3)
    for period in (0.9e-3, 0.0, float("nan")):
        with pytest.raises(ValueError, match=r"period must be at least a step, 0\.001 s, got"):
            MujocoPlant(Clock(1), 0, period=period)
    with pytest.raises(ValueError, match=r"flaws\.friction must be 0 except in a MovingPlant, got 0\.2"):
        MujocoPlant(Clock(1), 0, PERIOD, Flaws(friction=0.2))
