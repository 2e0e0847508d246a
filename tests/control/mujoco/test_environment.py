"""The grasp environment is one, and rewards who lifts."""

import numpy as np
import pytest

pytest.importorskip("mujoco")
gymnasium = pytest.importorskip("gymnasium", reason="the optional extra [gymnasium]")

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
    environment, heights = GraspEnvironment(), []
    for _ in range(2):
        environment.reset(seed=5)
        for _ in range(30):
            observation, *_ = environment.step(np.tile([0.8, 0.1], 3))
        heights.append(observation)
    np.testing.assert_array_equal(*heights)


def test_wrong_input_is_refused():
    with pytest.raises(ValueError, match="shapes must be of box"):
        GraspEnvironment(shapes=("torus",))
    with pytest.raises(ValueError, match="change must be above 0"):
        GraspEnvironment(change=0.0)
    environment = GraspEnvironment()
    environment.reset(seed=0)
    with pytest.raises(ValueError, match="action must be 6 finite numbers"):
        environment.step(np.full(6, np.nan))
