"""A gymnasium environment: press on a plane of unknown distance with a contact force, by changing tensions.

Needs the optional extra: pip install -e '.[gymnasium]'. Importing this registers fingerfem/Hold-v0:
gymnasium.make("control.environment:fingerfem/Hold-v0").
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rom.console.packages import require

require("gymnasium")

import gymnasium  # noqa: E402

from control.finger import Finger  # noqa: E402
from control.model import Model  # noqa: E402
from control.motion import for_each  # noqa: E402
from control.plant import Flaws, MovingPlant, SimulatedPlant  # noqa: E402
from rom import load  # noqa: E402
from rom.rod.touched_rod import TouchedRod  # noqa: E402

NAME = "fingerfem/Hold-v0"
FELT = 10.0  # times the largest target: what a sensor says beyond is not observed
DRAWS = 1000  # of planes and targets, until one can be held
CRUSHED = 2.0  # times the target that ends an episode


class HoldEnvironment(gymnasium.Env[np.ndarray, np.ndarray]):
    """One finger, a target and a plane; both are drawn anew in every episode, and the target can be held.

    Observation: tensions, contact force felt and target, over the largest tensions and target; shape (tensions + 2,)
    [-]. Action: change of every tension over `change`, shape (tensions,), in [-1, 1]. Reward: minus |felt - target| by
    the target, at least -1; an object pressed with twice its target is crushed, which costs 10 and ends the episode.

    Args:
        model: of a finger before an obstacle; the bundled one by default.
        targets: least and largest contact force [N].
        change: most that a tension changes in a step [N]; of a finger with chambers one for each load [N, Pa].
        steps: of an episode.
        flaws: of the simulated finger: delay and noise of its sensor and, with a density, friction of its tendons.
        density: of its rubber [kg/m^3]: a finger of elements moves as its mass lets it, in steps of the flaws' period.
            Without one it is at rest after every change. If it moves out of its elements' domain the episode ends.

    Raises:
        ValueError: a model without an obstacle, a table with a density, friction without one, or targets that are not
            in order above 0.
    """

    metadata = {"render_modes": []}

    def __init__(
        self,
        model: Model | None = None,
        targets: tuple[float, float] = (0.5, 3.0),
        change: ArrayLike = 2.0,
        steps: int = 200,
        flaws: Flaws | None = None,
        density: float | None = None,
    ):
        model = load() if model is None else model
        if not model.has_obstacle:
            raise ValueError("model must have an obstacle to press on, got a scene without one")
        if not 0 < targets[0] <= targets[1] < np.inf:
            raise ValueError(f"targets must be in order above 0 N, got {targets}")
        self._model, self._targets, self._steps, self._flaws = model, targets, steps, flaws
        if density is not None and not isinstance(model, TouchedRod):
            raise ValueError(f"density must be left out: only fingers of elements move, got {density}")
        if flaws is not None and density is None:
            flaws.without_friction()
        self._density = density
        self._finger = Finger(model)
        self._change = for_each("change", change, model.parameters[:-1])
        n = len(self._finger.lower)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (n,), np.float32)
        high = np.array([*np.ones(n), FELT, 1.0], np.float32)
        self.observation_space = gymnasium.spaces.Box(np.array([*np.zeros(n), -1.0, 0.0], np.float32), high)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Draw a plane and a target; `options` may give them: distance [m], target [N].

        Returns:
            the observation, shape (tensions + 2,), see the class; and what is drawn.
        """
        super().reset(seed=seed)
        lower, upper = self._model.limits
        chosen = options or {}
        for _ in range(DRAWS):
            distance = float(chosen.get("distance", self.np_random.uniform(lower[-1], upper[-1])))
            self._target = float(chosen.get("target", self.np_random.uniform(*self._targets)))
            if self._finger.hold(self._target, distance).converged:
                break
            if {"distance", "target"} <= chosen.keys():
                raise ValueError(f"target must be within reach at d = {distance:g} m, got {self._target:g} N")
        else:
            raise ValueError(f"target and distance must leave something within reach, got {chosen or self._targets}")
        self._plant = self._plant_at(distance, int(self.np_random.integers(2**31)))
        self._tensions, self._taken = self._finger.lower.copy(), 0
        self._felt = self._plant.pull(self._tensions)
        return self._observation(), {"distance": distance, "target": self._target}

    def _plant_at(self, distance: float, seed: int) -> SimulatedPlant | MovingPlant:
        if self._density is None or not isinstance(self._model, TouchedRod):
            return SimulatedPlant(self._model, distance, self._flaws, seed=seed)
        return MovingPlant(self._model, distance, self._density, self._flaws, seed=seed)

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Change the tensions; what is felt then."""
        wanted = np.asarray(action, float)
        if wanted.shape != self._tensions.shape or not np.isfinite(wanted).all():
            raise ValueError(f"action must be {len(self._tensions)} finite numbers, got {action}")
        change = self._change * np.clip(wanted, -1.0, 1.0)
        self._tensions = np.clip(self._tensions + change, self._finger.lower, self._finger.upper)
        self._taken += 1
        try:
            self._felt, lost = self._plant.pull(self._tensions), False
        except ValueError:
            if self._density is None:
                raise
            lost = True
        crushed = self._plant.contact_force > CRUSHED * self._target
        reward = -10.0 if crushed or lost else -min(abs(self._felt - self._target) / self._target, 1.0)
        info = {"contact_force": self._plant.contact_force, "crushed": crushed, "lost": lost}
        return self._observation(), reward, crushed or lost, self._taken >= self._steps, info

    def _observation(self) -> np.ndarray:
        scaled = self._tensions / np.maximum(self._finger.upper, 1e-9)
        largest = self._targets[1]
        felt = np.clip(self._felt / largest, -1.0, FELT)
        return np.array([*scaled, felt, min(self._target / largest, 1.0)], np.float32)


if NAME not in gymnasium.registry:
    gymnasium.register(id=NAME, entry_point="control.environment:HoldEnvironment")
