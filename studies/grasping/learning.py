"""The grasp environment: steps per second, and what a random policy and this project's controllers make of it."""

from __future__ import annotations

import time
from collections.abc import Callable

import gymnasium
import numpy as np

from control import GraspOptions
from control.mujoco.environment import LARGEST, NAME, GraspEnvironment
from studies.grasping.closing import GENTLY, Closing
from studies.runner import Run

EPISODES, QUICK_EPISODES = 40, 4
LIFTED = 0.045  # of 50 mm [m]
FORCES = (0.5, 1.0, 2.0)  # that the controllers hold, whatever stands there [N]
TIMED, ENVIRONMENTS = 150, 2  # steps that are timed; of environments at once
Policy = Callable[[np.ndarray], np.ndarray]


def random_policy(environment: GraspEnvironment, seed: int) -> Policy:
    """Any action."""
    random = np.random.default_rng(seed)
    return lambda _: random.uniform(-1, 1, environment.action_space.shape)


def controllers(environment: GraspEnvironment, force: float) -> Policy:
    """The project's own, who feel and do not know what stands there: all squeeze with one force [N]."""
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


def played(policy: Callable[[GraspEnvironment, int], Policy], episodes: int) -> dict:
    """How a policy fares in episodes, the same for all."""
    environment = GraspEnvironment()
    rewards, lifted, crushed, beyond = [], 0, 0, 0
    for seed in range(episodes):
        observation, _ = environment.reset(seed=seed)
        act, total, ended, over = policy(environment, seed), 0.0, False, False
        while not (ended or over):
            observation, reward, ended, over, told = environment.step(act(observation))
            total += reward
        rewards.append(total)
        crushed += told["crushed"]
        lifted += not told["crushed"] and told["lifted"] > LIFTED
        beyond += told["beyond"]
    return {
        "episodes": episodes,
        "reward": float(np.mean(rewards)),
        "lifted": lifted,
        "crushed": crushed,
        "beyond": beyond,
    }


def steps_per_second(count: int) -> float:
    """Of environments side by side, each in a process of its own, under random actions."""
    made = gymnasium.make_vec(
        f"control.mujoco.environment:{NAME}", num_envs=count, vectorization_mode="async" if count > 1 else "sync"
    )
    made.reset(seed=0)
    made.action_space.seed(0)
    actions = [made.action_space.sample() for _ in range(TIMED)]
    begun = time.perf_counter()
    for action in actions:
        made.step(action)
    taken = time.perf_counter() - begun
    made.close()
    return count * TIMED / taken


def measure(run: Run) -> dict:
    """Both, and the controllers at several forces."""
    episodes = QUICK_EPISODES if run.quick else EPISODES
    rows = [{"policy": "random"} | played(random_policy, episodes)]
    for force in FORCES:

        def policy(environment: GraspEnvironment, _: int, force: float = force) -> Policy:
            return controllers(environment, force)

        rows.append({"policy": f"controllers, {force:g} N"} | played(policy, episodes))
    speeds = [{"environments": count, "steps_per_second": steps_per_second(count)} for count in (1, ENVIRONMENTS)]
    return {"policies": rows, "speeds": speeds}
