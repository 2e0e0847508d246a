"""The gymnasium environment is one, and this project's controller solves it."""

import numpy as np
import pytest

pytest.importorskip("gymnasium", reason="the optional extra [gymnasium]")

import gymnasium
from episodes import assert_last_observation, assert_same_again
from gymnasium.utils.env_checker import check_env

import rom
from control import Finger, Flaws
from control.environment import NAME, HoldEnvironment


@pytest.mark.filterwarnings("error")
def test_it_passes_gymnasiums_own_check(table):
    check_env(HoldEnvironment(table, flaws=Flaws(noise=0.01)), skip_render_check=True)


def test_an_episode_is_the_same_again(table):
    assert_same_again(lambda: HoldEnvironment(table, flaws=Flaws(noise=0.05, delay=2)), closing=np.ones(2))


def test_vectors_keep_the_last_observation(table):
    assert_last_observation(lambda: HoldEnvironment(table, steps=4, flaws=Flaws(noise=0.05)), steps=4)


def test_a_policy_that_has_the_plane_is_soon_rewarded_fully(table):
    environment, finger = HoldEnvironment(table), Finger(table)
    for seed in range(5):
        _, known = environment.reset(seed=seed)
        goal = finger.hold(known["target"], known["distance"]).tensions
        tensions, rewards = finger.lower.copy(), []
        for _ in range(60):
            action = np.clip((goal - tensions) / 2.0, -1, 1)
            _, reward, ended, *_ = environment.step(action)
            tensions = np.clip(tensions + 2.0 * action, finger.lower, finger.upper)
            rewards.append(reward)
            assert not ended
        assert rewards[-1] == pytest.approx(0.0, abs=1e-4)


def test_who_pulls_on_and_on_crushes_the_object(table):
    environment = HoldEnvironment(table)
    environment.reset(seed=1, options={"distance": 0.010, "target": 1.0})
    for _ in range(60):
        *_, reward, ended, _, info = environment.step(np.ones(2))
        if ended:
            break
    assert ended and info["crushed"] and reward == -10.0


def test_wrong_input_is_refused(table):
    with pytest.raises(ValueError, match="targets must be in order above 0 N"):
        HoldEnvironment(table, targets=(3.0, 1.0))
    with pytest.raises(ValueError, match=r"within reach at d = 0\.0305 m, got 5 N"):
        HoldEnvironment(table).reset(options={"distance": 0.0305, "target": 5.0})


def test_what_nobody_could_hold_is_refused_and_an_action_that_is_none_changes_nothing(table):
    with pytest.raises(ValueError, match="must leave something within reach"):
        HoldEnvironment(table, targets=(100.0, 200.0)).reset(seed=1)
    environment = HoldEnvironment(table)
    environment.reset(seed=1)
    with pytest.raises(ValueError, match="action must be 2 finite numbers"):
        environment.step(np.array([np.nan, 0.0]))
    assert np.isfinite(environment.step(np.array([1.0, 0.0]))[0]).all()


def test_it_is_registered_and_presses_the_bundled_finger_by_default():
    made = gymnasium.make(f"control.environment:{NAME}", targets=(1.0, 2.0))
    observation, drawn = made.reset(seed=3)
    assert 1.0 <= drawn["target"] <= 2.0
    assert observation.shape == (len(rom.load().names) + 1,)


def test_a_finger_with_mass_swings_and_an_episode_ends_where_it_leaves_its_domain():
    environment = HoldEnvironment(rom.load(), flaws=Flaws(period=1e-3), density=1100.0, change=1.0)
    environment.reset(seed=1, options={"distance": 0.01, "target": 1.0})
    felt = [environment.step(np.array([0.5, 0.0]))[0][2] for _ in range(60)]
    assert felt[0] == 0.0 < max(felt)
    with pytest.raises(ValueError, match=r"flaws\.friction must be 0 except in a MovingPlant"):
        HoldEnvironment(rom.load(), flaws=Flaws(friction=0.2))
    rubbing = HoldEnvironment(rom.load(), flaws=Flaws(period=1e-3, friction=0.2), density=1100.0, change=1.0)
    rubbing.reset(seed=1, options={"distance": 0.01, "target": 1.0})
    assert max(rubbing.step(np.array([0.5, 0.0]))[0][2] for _ in range(60)) < max(felt)
    wild = HoldEnvironment(rom.load(), density=1100.0, change=100.0)
    wild.reset(seed=1, options={"distance": 0.01, "target": 1.0})
    ends = [wild.step(np.array([sign, -sign], float)) for sign in (1, -1, 1, -1)]
    assert any(reward == -10.0 and ended and info["lost"] for _, reward, ended, _, info in ends)
