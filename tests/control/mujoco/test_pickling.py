"""Simulations, their plants and the environment go on from a pickle as they would have."""

import multiprocessing
import pickle

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco", reason="needs the extra mujoco")
pytest.importorskip("gymnasium")

from control.mujoco import plants  # noqa: E402
from control.mujoco.environment import GraspEnvironment  # noqa: E402


def taken(environment: GraspEnvironment, steps: int = 3) -> list:
    action = np.tile(np.array([1.0, 0.0], np.float32), 3)
    return [environment.step(action)[:4] for _ in range(steps)]


def same(ours: list, theirs: list) -> bool:
    return all(np.array_equal(a[0], b[0]) and a[1:] == b[1:] for a, b in zip(ours, theirs, strict=True))


@pytest.fixture
def environment() -> GraspEnvironment:
    return GraspEnvironment()


@pytest.mark.parametrize("before", [0, 4])
def test_the_environment_goes_on_from_a_pickle_with_equal_bits(environment, before):
    unused = pickle.loads(pickle.dumps(environment))
    assert np.array_equal(unused.reset(seed=5)[0], environment.reset(seed=5)[0])
    taken(environment, before)
    again = pickle.loads(pickle.dumps(environment))
    assert same(taken(environment), taken(again))
    assert np.array_equal(environment.reset()[0], again.reset()[0])


def test_a_spawned_process_goes_on_with_the_environment(environment):
    environment.reset(seed=5)
    taken(environment, 2)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        theirs = pool.apply(taken, (environment,))
    assert same(taken(environment), theirs)


def test_the_plants_of_a_simulation_stay_in_one_simulation(environment):
    environment.reset(seed=5)
    driven = plants(environment.simulation)
    again = pickle.loads(pickle.dumps(driven))
    for _ in range(3):
        assert [one.pull([20.0, 0.0]) for one in driven] == [one.pull([20.0, 0.0]) for one in again]
