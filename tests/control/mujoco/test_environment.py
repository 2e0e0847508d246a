"""The grasp environment is one, and rewards who lifts."""

import numpy as np
import pytest

pytest.importorskip("mujoco")
gymnasium = pytest.importorskip("gymnasium", reason="the optional extra [gymnasium]")

from episodes import assert_last_observation, assert_same_again  # noqa: E402
from gymnasium.utils.env_checker import check_env  # noqa: E402

from control import GraspOptions  # noqa: E402
from control.mujoco.environment import LARGEST, NAME, GraspEnvironment  # noqa: E402
from studies.grasping.closing import GENTLY, Closing  # noqa: E402


@pytest.mark.filterwarnings("error")
def test_it_passes_gymnasiums_own_check():
    check_env(GraspEnvironment(), skip_render_check=True)


def test_it_is_made_many_times_over_by_its_name():
    made = gymnasium.make_vec(f"control.mujoco.environment:{NAME}", num_envs=2, vectorization_mode="sync")
    observations, info = made.reset(seed=3)
    assert observations.shape == (2, 11)
    assert info["solid"][0].mass != info["solid"][1].mass
    observations, rewards, *_ = made.step(np.ones((2, 6)))
    assert np.isfinite(observations).all() and np.isfinite(rewards).all()
    made.close()


def random_policy(environment: GraspEnvironment, seed: int):
    """Any action."""
    random = np.random.default_rng(seed)
    return lambda _: random.uniform(-1, 1, environment.action_space.shape)


def controllers(environment: GraspEnvironment, force: float):
    """The project's own, without the solid's mass and strength: all squeeze with one force [N]."""
    gripper, size = environment.gripper, len(environment.gripper.fingers)
    options = GraspOptions(
        period=environment.period, approach_step=0.5, squeeze_steps=15, tolerance=0.15, dead_band=0.15, settling=0.05
    )
    closing = Closing(gripper, gripper.grips(GENTLY * force, options), np.full(size, force))
    upper = gripper.fingers[0].upper

    def act(observation: np.ndarray) -> np.ndarray:
        now, felt = observation[: -size - 2].reshape(size, -1) * upper, LARGEST * observation[-size - 2 : -2]
        for grip, target, feels in zip(closing.grips, closing.targets(), felt, strict=True):
            grip.target = float(target)
            grip.step(float(feels))
        wanted = np.array([grip.tensions for grip in closing.grips])
        return np.clip((wanted - now) / environment.change, -1, 1).ravel()

    return act


def played(policy, episodes: int) -> tuple[float, int]:
    """Mean reward of a policy, and how often it lifts the solid by nearly all of 50 mm."""
    environment, rewards, lifted = GraspEnvironment(), [], 0
    for seed in range(episodes):
        observation, _ = environment.reset(seed=seed)
        act, total, ended, over = policy(environment, seed), 0.0, False, False
        while not (ended or over):
            observation, reward, ended, over, info = environment.step(act(observation))
            total += reward
        rewards.append(total)
        lifted += info["lifted"] > 0.045
    return float(np.mean(rewards)), lifted


@pytest.mark.long
def test_controllers_that_feel_lift_and_random_actions_do_not():
    reward, lifted = played(lambda environment, _: controllers(environment, 1.0), 6)
    blind, none = played(random_policy, 6)
    assert lifted >= 3 and none == 0
    assert reward > 0.4 > blind + 0.3


def test_who_pulls_on_and_on_crushes_what_is_weak():
    environment = GraspEnvironment(shapes=("cylinder",))
    for seed in range(20):
        _, info = environment.reset(seed=seed)
        if info["solid"].admissible_force < 1.5:
            break
    total, ended = 0.0, False
    for _ in range(60):
        _, reward, ended, _, info = environment.step(np.tile([1.0, 0.0], 3))
        total += reward
        if ended:
            break
    assert ended and info["crushed"] and total == pytest.approx(-1.0, abs=0.05)


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
        observation, reward, ended, _, info = environment.step(np.zeros(6))
        assert environment.observation_space.contains(observation) and np.isfinite([reward, info["lifted"]]).all()
        assert np.isfinite(info["contact_forces"]).all()
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
