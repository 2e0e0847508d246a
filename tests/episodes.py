"""Checks of any gymnasium environment: episodes are the same again, and vectors keep the last observation."""

import numpy as np
from gymnasium.vector import AutoresetMode, SyncVectorEnv


def episode(environment, seed, closing, steps=30):
    """Observations and rewards of random shares of an action that closes, shapes (steps + 1, n) and (steps,)."""
    observation, _ = environment.reset(seed=seed)
    random, observations, rewards = np.random.default_rng(0), [observation], []
    for _ in range(steps):
        action = (random.uniform(0.5, 1.0, len(closing)) * closing).astype(np.float32)
        observation, reward, ended, over, _ = environment.step(action)
        assert environment.observation_space.contains(observation)
        observations.append(observation)
        rewards.append(reward)
        if ended or over:
            break
    return np.array(observations), np.array(rewards)


def assert_same_again(make, closing):
    """Equal bits after reset(seed): again, in another instance, after another seed, and in the episodes that follow."""
    one, other = make(), make()
    first, following, another = (episode(one, seed, closing) for seed in (5, None, 6))
    assert not np.array_equal(another[0], first[0])
    found = episode(one, 5, closing), episode(other, 5, closing), episode(other, None, closing)
    for again, expected in zip(found, (first, first, following), strict=True):
        np.testing.assert_array_equal(again[0], expected[0])
        np.testing.assert_array_equal(again[1], expected[1])


def assert_last_observation(make, steps):
    """A vector gives what its environments give alone, also what they observe last, in every mode of autoreset."""
    seeds, actions = (3, 4), np.random.default_rng(1).uniform(-1.0, 1.0, (steps, 2, *make().action_space.shape))
    expected, following = [], []
    for k, seed in enumerate(seeds):
        alone = make()
        alone.reset(seed=seed)
        for action in actions[:, k]:
            last, *_, over, _ = alone.step(action)
        assert over
        expected.append(last)
        following.append(alone.reset()[0])
    for mode in AutoresetMode:
        vector = SyncVectorEnv([make] * 2, autoreset_mode=mode)
        vector.reset(seed=list(seeds))
        for action in actions:
            found, _, _, over, info = vector.step(action)
        assert over.all()
        if mode == AutoresetMode.SAME_STEP:
            np.testing.assert_array_equal(np.stack(info["final_obs"]), expected)
            np.testing.assert_array_equal(found, following)
        else:
            np.testing.assert_array_equal(found, expected)
        if mode == AutoresetMode.NEXT_STEP:
            np.testing.assert_array_equal(vector.step(actions[0])[0], following)
        if mode == AutoresetMode.DISABLED:
            again, _ = vector.reset(options={"reset_mask": np.array([True, True])})
            np.testing.assert_array_equal(again, following)
        vector.close()
