"""The grasp environment is one, and rewards who lifts."""

import numpy as np
import pytest

pytest.importorskip("mujoco")
gymnasium = pytest.importorskip("gymnasium", reason="the optional extra [gymnasium]")

from episodes import assert_last_observation, assert_same_again  # noqa: E402
from gymnasium.utils.env_checker import check_env  # noqa: E402

from control.mujoco.environment import NAME, GraspEnvironment  # noqa: E402
from studies.grasping.learning import controllers, played, random_policy  # noqa: E402


@pytest.mark.filterwarnings("error")
def test_it_passes_gymnasiums_own_check():
    check_env(GraspEnvironment(), skip_render_check=True)


def test_it_is_made_many_times_over_by_its_name():
    made = gymnasium.make_vec(f"control.mujoco.environment:{NAME}", num_envs=2, vectorization_mode="sync")
    observations, told = made.reset(seed=3)
    assert observations.shape == (2, 11)
    assert told["solid"][0].mass != told["solid"][1].mass
    observations, rewards, *_ = made.step(np.ones((2, 6)))
    assert np.isfinite(observations).all() and np.isfinite(rewards).all()
    made.close()


def test_who_feels_lifts_and_who_does_not_does_not():
    known = played(lambda environment, _: controllers(environment, 1.0), 6)
    blind = played(random_policy, 6)
    assert known["lifted"] >= 3 and blind["lifted"] == 0
    assert known["reward"] > 0.4 > blind["reward"] + 0.3


def test_who_pulls_on_and_on_crushes_what_is_weak():
    environment = GraspEnvironment(shapes=("cylinder",))
    for seed in range(20):
        _, told = environment.reset(seed=seed)
        if told["solid"].admissible_force < 1.5:
            break
    total, ended = 0.0, False
    for _ in range(60):
        _, reward, ended, _, told = environment.step(np.tile([1.0, 0.0], 3))
        total += reward
        if ended:
            break
    assert ended and told["crushed"] and total == pytest.approx(-1.0, abs=0.05)


def test_an_episode_is_the_same_again():
    assert_same_again(GraspEnvironment, closing=np.tile([1.0, 0.0], 3))


def test_vectors_keep_the_last_observation():
    assert_last_observation(lambda: GraspEnvironment(steps=4, shapes=("cylinder",)), steps=4)


@pytest.mark.parametrize("force", [1e3, 1e12, np.nan])
@pytest.mark.parametrize("body", ["finger 0 plate 0", "object"])
def test_a_simulation_that_stops_ends_the_episode_with_what_was_felt_last(body, force, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # MuJoCo writes its warnings to where it runs
    environment = GraspEnvironment()
    environment.reset(seed=1)
    for _ in range(5):
        environment.step(np.tile([1.0, 0.0], 3))
    simulation = environment.simulation
    simulation.data.xfrc_applied[simulation.model.body(body).id, :3] = force
    ended = False
    for _ in range(3):
        observation, reward, ended, _, told = environment.step(np.zeros(6))
        assert environment.observation_space.contains(observation) and np.isfinite([reward, told["lifted"]]).all()
        assert np.isfinite(told["contact_forces"]).all()
    assert ended or (body == "object" and force == 1e3)  # what is thrown away is not lost


def test_wrong_input_is_refused():
    with pytest.raises(ValueError, match="shapes must be of box"):
        GraspEnvironment(shapes=("torus",))
    with pytest.raises(ValueError, match="change must be above 0"):
        GraspEnvironment(change=0.0)
    environment = GraspEnvironment()
    environment.reset(seed=0)
    with pytest.raises(ValueError, match="action must be 6 finite numbers"):
        environment.step(np.full(6, np.nan))
