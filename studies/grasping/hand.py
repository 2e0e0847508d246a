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
from control.mujoco.table import edges
from rom import Rod
from studies.grasping.trials import PERIOD

RAISED = 0.015  # height of the gripper above its planned position at the start [m]
CRUSHING = 0.02  # [s]: blows of rigid bodies that are shorter crush nothing
FELT = 0.15  # of the held force: a change by so much is the table's, when a solid is put down [-]
SLOWLY = 0.005  # speed at which a solid approaches the table [m/s]
CLEAR, OPENING = 0.002, 0.6  # how much higher than open fingers get longer the arm goes [m], and how long it takes [s]
SHARES = np.linspace(0.0, 1.0, 51)  # of the way from tensions to others
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
        self.forces.append(self.on_solid())
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
        """Open from tensions, shape (fingers, tensions) [N]."""
        self.phase = "open"
        self.open(tensions, np.zeros_like(tensions))

    def open(self, tensions: np.ndarray, goal: np.ndarray) -> None:
        """Change tensions to others, shapes (fingers, tensions) [N], as far as the arm has gone up.

        A finger gets longer with less tension, and one that sticks to a solid on a table would press it harder.
        So the inner edge of a free finger's plate, which touches, does not get lower.
        """
        ways = tensions[:, None] + SHARES[:, None] * (goal - tensions)[:, None]
        depths = np.array([[edges(self.rod, one)[0, 0] for one in way] for way in ways])
        longer = np.maximum.accumulate(depths - depths[:, :1], axis=1)
        begun, steps, rises = self.height, round(OPENING / PERIOD), float(longer[:, -1].max()) + CLEAR
        for step in range(steps):
            self.mount[2] = begun + rises * (step + 1) / steps
            shares = np.array([np.interp(self.height - begun, one, SHARES) for one in longer])
            self.pull(tensions + shares[:, None] * (goal - tensions))
            self.look()

    def move(self, place: np.ndarray, seconds: float) -> None:
        """Move the arm to a place, shape (3,) [m], in a time [s]; tensions stay."""
        begun, steps = self.mount[:3].copy(), round(seconds / PERIOD)
        for step in range(steps):
            self.mount[:3] = begun + (place - begun) * (step + 1) / steps
            self.pull(self.simulation.wanted.copy())
            self.look()

    def on_solid(self) -> np.ndarray:
        """Contact forces of fingers on the solid, without those on each other, shape (fingers,) [N]."""
        model, data = self.simulation.model, self.simulation.data
        found, force, solid = np.zeros(len(self.driven)), np.zeros(6), model.geom("object").id
        for k, pair in enumerate(data.contact.geom):
            if solid in pair:
                finger = self.simulation.finger_of(pair[0] + pair[1] - solid)
                mujoco.mj_contactForce(model, data, k, force)
                found[finger] += force[0] * (finger >= 0)
        return found

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
