"""A gymnasium environment: three fingers pick up a solid of unknown position.

It needs the optional extras: pip install -e '.[mujoco,gymnasium]'. Importing this registers fingerfem/Grasp-v0:

    gymnasium.make_vec("control.mujoco.environment:fingerfem/Grasp-v0", num_envs=4, vectorization_mode="async")
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rom.console.packages import require

require("gymnasium")

import gymnasium  # noqa: E402

from control.grasping.gripper import Gripper  # noqa: E402
from control.motion import for_each  # noqa: E402
from control.mujoco.simulation import Simulation, SimulationStopped  # noqa: E402
from control.mujoco.solids import SHAPES, random_error, random_solid  # noqa: E402
from control.mujoco.table import table  # noqa: E402
from rom import TouchedSegment  # noqa: E402

NAME = "fingerfem/Grasp-v0"
LARGEST = 5.0  # contact force that is observed as 1 [N]
FELT = 4.0  # largest observed contact force over LARGEST [-]
HEIGHT = 0.05  # to which the palm is lifted [m]
SOON = 5  # steps over which a crushing force is averaged
MARGIN = 0.2  # admissible relative error of contact forces [-]
DRAWS = 1000  # largest number of drawn solids until one can be held
CLOSES, LIFTS = 0.5, 0.75  # shares of an episode at which the lift of the palm begins and ends [-]


class GraspEnvironment(gymnasium.Env[np.ndarray, np.ndarray]):
    """A gripper above a solid of random shape, size, mass, friction, strength and position.

    In the first half of an episode the palm stays; in the next quarter it is lifted by 50 mm. Observation: all tensions
    over the largest, contact forces of the fingers over 5 N, height of the palm over 50 mm, share of the episode; shape
    (fingers tensions + fingers + 2,) [-]. Action: change of every tension over `change`, shape (fingers tensions,), in
    [-1, 1]. Reward: gain of the solid's height over 50 mm, minus 1 if it is crushed. A crushed solid or a stopped
    simulation ends the episode. `step` describes `info`.

    Args:
        model: of every finger; by default the bundled one.
        shapes: to draw from, see control.mujoco.solids.
        change: largest change of a tension in a step [N]; with chambers one for each load [N, Pa].
        steps: of an episode.
        period: of a step [s].

    Raises:
        ValueError: a shape that does not exist, several segments, or numbers that are not above 0.
    """

    metadata = {"render_modes": []}

    def __init__(
        self,
        model: TouchedSegment | None = None,
        shapes: tuple[str, ...] = SHAPES,
        change: ArrayLike = 2.0,
        steps: int = 200,
        period: float = 0.02,
    ):
        model = model or TouchedSegment.load()
        if len(model.rod.segments) > 1:
            raise ValueError(f"model must be of one segment, got {len(model.rod.segments)}")
        if not shapes or not set(shapes) <= set(SHAPES):
            raise ValueError(f"shapes must be of {', '.join(SHAPES)}, got {shapes}")
        for name, value in (("steps", steps), ("period", period)):
            if not 0 < value < np.inf:
                raise ValueError(f"{name} must be above 0, got {value}")
        self.gripper, self._rod = Gripper(model), model.rod
        self._shapes, self._steps, self._period = shapes, steps, period
        self.change = for_each("change", change, self._rod.parameters)
        finger = self.gripper.fingers[0]
        self._lower, self._upper = finger.lower, finger.upper
        n, tensions = len(self.gripper.fingers), len(finger.lower)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (n * tensions,), np.float32)
        high = np.concatenate([np.ones(n * tensions), np.full(n, FELT), [2.0, 1.0]]).astype(np.float32)
        low = np.concatenate([np.zeros(n * tensions + n), [-1.0, 0.0]]).astype(np.float32)
        self.observation_space = gymnasium.spaces.Box(low, high)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Draw a solid that can be held, and the gripper's position error; `options` may give its "shape".

        Returns:
            The observation, see the class; the drawn "solid" and "error" of the position [m].
        """
        super().reset(seed=seed)
        shape = (options or {}).get("shape") or str(self.np_random.choice(self._shapes))
        for _ in range(DRAWS):
            self.solid = random_solid(self.np_random, shape)
            turn = self.solid.best_turn(self.gripper.directions)
            held = self.solid.turned(turn).held(self.gripper.directions)
            if self.gripper.targets(held, margin=MARGIN).exist:
                break
        else:
            raise ValueError(f"shape must be one that the fingers can hold, got {shape!r} and none of {DRAWS} solids")
        error = random_error(self.np_random)
        self.simulation: Simulation = table(self.gripper, self._rod, self.solid, error, turn)
        self._tensions = np.tile(self._lower, (len(self.gripper.fingers), 1))
        self._taken, self._past, self._palm = 0, [np.zeros(len(self.gripper.fingers))], 0.0
        self._rest = self._height = float(self.simulation.data.body("object").xpos[2])
        return self._observation(), {"solid": self.solid, "error": error}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Change the tensions, and simulate a period.

        Returns:
            Observation, reward, whether the solid was crushed or the simulation stopped, whether the time is over, and
            the info: true contact forces [N], gained height of the solid [m], whether it is crushed, and whether a
            finger left its trained domain.
        """
        wanted = np.asarray(action, float)
        if wanted.shape != self.action_space.shape or not np.isfinite(wanted).all():
            raise ValueError(f"action must be {self._tensions.size} finite numbers, got {action}")
        change = self.change * np.clip(wanted, -1.0, 1.0).reshape(self._tensions.shape)
        self._tensions = np.clip(self._tensions + change, self._lower, self._upper)
        simulation, self._taken = self.simulation, self._taken + 1
        for finger, tensions in enumerate(self._tensions):
            simulation.pull(finger, tensions)
        simulation.data.ctrl[2] = HEIGHT * np.clip((self.elapsed - CLOSES) / (LIFTS - CLOSES), 0.0, 1.0)
        lost, forces = False, self._past[-1]
        try:
            simulation.advance(self._taken * self._period)
            forces, self._palm = simulation.contact_forces(), float(simulation.data.joint("z").qpos[0])
        except SimulationStopped:  # the last contact forces stay
            lost = True
        self._past = [*self._past[1 - SOON :], forces]
        crushed = bool(np.mean(self._past, axis=0).max() > self.solid.admissible_force)
        height = self._height if lost else float(simulation.data.body("object").xpos[2])
        reward, self._height = float(np.clip((height - self._height) / HEIGHT, -1.0, 1.0)), height
        info = {
            "contact_forces": self._past[-1],
            "lifted": height - self._rest,
            "crushed": crushed,
            "beyond": bool((simulation.left | simulation.lost).any()),
        }
        return self._observation(), reward - crushed, crushed or lost, self._taken >= self._steps, info

    @property
    def elapsed(self) -> float:
        """Elapsed share of the episode [-]."""
        return self._taken / self._steps

    @property
    def period(self) -> float:
        """Duration of a step [s]."""
        return self._period

    def _observation(self) -> np.ndarray:
        felt = np.clip(self._past[-1] / LARGEST, 0.0, FELT)
        height = np.clip(self._palm / HEIGHT, -1.0, 2.0)
        scaled = (self._tensions / np.maximum(self._upper, 1e-9)).ravel()
        return np.array([*scaled, *felt, height, min(self.elapsed, 1.0)], np.float32)


if NAME not in gymnasium.registry:
    gymnasium.register(id=NAME, entry_point="control.mujoco.environment:GraspEnvironment")
