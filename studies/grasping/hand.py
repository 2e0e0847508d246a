"""A gripper above a table in a simulation: its arm moves, its fingers hold or open, and what they press is recorded."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import mujoco
import numpy as np

from control import Gripper
from control.grasping.grasp_controller import Grip
from control.loop import run
from control.mujoco import MujocoPlant, Simulation
from rom import Rod
from studies.grasping.trials import PERIOD

RAISED = 0.015  # height of the gripper above its planned position at the start [m]
CRUSHING = 0.02  # [s]: blows of rigid bodies that are shorter crush nothing
FELT = 0.15  # of the held force: a change by so much is the table's, when a solid is put down [-]
SLOWLY = 0.005  # speed at which a solid approaches the table [m/s]
# Fingers that open become longer: so they open where they cannot be pressed on the table.
CLEAR, CLEARING, OPENING = 0.002, 0.2, 0.6  # how far above it [m]; how long that and opening take [s]
TOGETHER = 4  # periods after which it is decided whether to go on
Look = Callable[[Simulation], None]


@dataclass
class Hand:
    """A gripper of a simulation, which begins above its planned position.

    Attributes:
        gripper, rod: the fingers.
        simulation, driven: of the gripper, and of every finger.
        looks: called after every period.
        forces: contact forces of every period in which the gripper may touch a solid, shapes (fingers,) [N].
        hardest: the largest of them, averaged over CRUSHING [N].
        phase: of the task, now; hardest_in: in which `hardest` was.
    """

    gripper: Gripper
    rod: Rod
    simulation: Simulation
    driven: list[MujocoPlant]
    looks: list[Look]
    forces: list[np.ndarray] = field(default_factory=list, init=False)
    hardest: float = field(default=0.0, init=False)
    phase: str = field(default="close", init=False)
    hardest_in: str = field(default="", init=False)

    def __post_init__(self) -> None:
        data = self.simulation.data
        data.ctrl[2] = data.joint("z").qpos[0] = RAISED
        mujoco.mj_forward(self.simulation.model, data)

    @property
    def mount(self) -> np.ndarray:
        """Target position of the arm from the planned one, shape (6,) [m, rad]."""
        return np.asarray(self.simulation.data.ctrl)

    @property
    def height(self) -> float:
        """Present height of the arm above the planned one [m]."""
        return float(self.simulation.data.joint("z").qpos[0])

    def show(self) -> None:
        """Call what looks."""
        for one in self.looks:
            one(self.simulation)

    def look(self) -> None:
        """Record contact forces."""
        self.forces.append(self.simulation.contact_forces())
        lately = self.forces[-round(CRUSHING / PERIOD) :]
        hard = float(np.mean(lately, axis=0).max())
        if hard > self.hardest:
            self.hardest, self.hardest_in = hard, self.phase
        self.show()

    def pull(self, tensions: np.ndarray) -> np.ndarray:
        """Readings after a period at tensions, shape (fingers, tensions); shape (fingers,) [N]."""
        return np.array([plant.pull(own) for plant, own in zip(self.driven, tensions, strict=True)])

    def carry(self, grips: list[Grip], axis: int, aim: float, seconds: float, doubt: Callable[[], str] = str) -> None:
        """Move one axis of the arm smoothly to its goal [m, rad], while the fingers hold, until there is a doubt."""
        steps, begun = round(seconds / PERIOD), float(self.mount[axis])
        shares = iter((np.arange(steps) + 1) / steps)

        def move(_: int) -> None:
            share = next(shares)
            self.mount[axis] = begun + share**3 * (10 - 15 * share + 6 * share**2) * (aim - begun)
            self.look()

        for first in range(0, steps, TOGETHER):
            if doubt():
                return
            run(grips, self.driven, min(TOGETHER, steps - first), move)

    def put_down(self, grips: list[Grip], table: float) -> None:
        """Go down slowly until the table is felt, at most to a height of the arm [m], and release.

        Tensions stay on the way: a solid on the table sticks, and a finger with less tension first presses harder.
        """
        held = felt = np.array([grip.felt for grip in grips])
        tensions = np.array([grip.tensions for grip in grips])
        while self.mount[2] > table and np.abs(felt - held).max() < FELT * held.mean():
            self.mount[2] -= SLOWLY * PERIOD
            felt = self.pull(tensions)
            self.look()
        self.release(tensions)

    def release(self, tensions: np.ndarray) -> None:
        """Go up at tensions, shape (fingers, tensions) [N], and open: fingers that stick would first press harder."""
        self.mount[2] += CLEAR
        self.stay(tensions, CLEARING)
        self.phase = "open"
        self.stay(np.zeros_like(self.simulation.wanted), OPENING)

    def stay(self, tensions: np.ndarray, seconds: float) -> None:
        """Hold tensions, shape (fingers, tensions) [N], for a time [s]."""
        for finger, pulled in enumerate(tensions):
            self.simulation.pull(finger, pulled)
        for _ in range(round(seconds / PERIOD)):
            self.simulation.advance(self.simulation.time + PERIOD)
            self.look()

    def on_table(self) -> float:
        """True height of the arm at which the palm is on the table [m]."""
        return self.height - float(self.simulation.data.body("palm").xpos[2])

    def below(self) -> float:
        """Distance of the solid's origin below the palm's [m]."""
        data = self.simulation.data
        return float(data.body("object").xpos[2] - data.body("palm").xpos[2])

    def beside(self) -> float:
        """Distance of the solid's origin from the axis of the palm [m]."""
        data = self.simulation.data
        return float(np.linalg.norm((data.body("object").xpos - data.body("palm").xpos)[:2]))

    def tilt(self) -> float:
        """Angle between the solid's axis and the vertical [rad]."""
        return float(np.arccos(np.clip(self.simulation.data.body("object").xmat[8], -1, 1)))
