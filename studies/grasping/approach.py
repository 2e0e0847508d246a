"""The way to a solid: fingers feel the table, bend beside the solid, and the arm yields to a finger that touches first."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np

from control import Gripper
from control.grasping.grasp_controller import Grip
from control.mujoco import MujocoPlant, Simulation
from control.mujoco.table import closing_at
from rom import Rod

RAISED = 0.015  # height of the gripper above its planned position at the start [m]
GOES_DOWN = 0.03  # [m/s]
TOUCHES = 2  # readings in a row that are contact
BENDING, LOWERING = 0.4, 0.3  # how long it takes to bend beside the solid, and to go down [s]
BESIDE, CLEAR = 0.001, 0.0005  # distances of bent fingers from the solid, and of fingers from the table [m]
YIELDS = 0.012  # speed of the arm at the contact force at which fingers wait for each other [m/s]
FARTHEST = 0.008  # most that the arm yields [m]


@dataclass
class Approach:
    """A gripper on its way.

    Attributes:
        simulation: with the gripper in its planned position.
        driven: its fingers.
        period: of their controllers [s].
        palm: planned height of the palm [m].
        look: called after every period.
    """

    gripper: Gripper
    rod: Rod
    simulation: Simulation
    driven: list[MujocoPlant]
    period: float
    palm: float
    look: Callable[[], None]

    def begin(self) -> None:
        """Raise the gripper, before the first step."""
        data = self.simulation.data
        data.ctrl[2] = data.joint("z").qpos[0] = RAISED
        mujoco.mj_forward(self.simulation.model, data)

    def feel_table(self, feel: float) -> None:
        """Go down with open fingers until most of them feel the table, then to the height that is planned above it.

        Args:
            feel: contact force that counts as contact [N].
        """
        mount, heights, touching = self.simulation.data.ctrl, list[float](), 0
        longest = closing_at(self.gripper, self.rod, self.gripper.radius)[2]
        while touching < TOUCHES:
            mount[2] -= GOES_DOWN * self.period
            felt = self._pull(np.zeros(len(self.rod.names)))
            heights.append(float(self.simulation.data.joint("z").qpos[0]))
            touching = touching + 1 if np.median(felt) > feel else 0
        late = TOUCHES - 1 + round(self.driven[0].age / self.period)
        self.table = heights[-1 - min(late, len(heights) - 1)] - longest

    def bend(self, reach: float, radius: float) -> np.ndarray:
        """Bend beside a solid, then go down to the height of the grasp.

        Args:
            reach: largest distance of the solid from its axis, with the error of its position [m].
            radius: at which fingers touch it [m].

        Returns:
            Tensions, shape (tensions,) [N].
        """
        beside, tensions = min(reach + BESIDE, self.gripper.radius), np.zeros(len(self.rod.names))
        lead, _, end = closing_at(self.gripper, self.rod, beside)
        clear = max(end, closing_at(self.gripper, self.rod, radius)[2])
        height = self.table + max(self.palm, clear + CLEAR)
        mount = self.simulation.data.ctrl
        for seconds, aim, pulled in ((BENDING, height + RAISED, lead), (LOWERING, height, lead)):
            steps, begun, before = round(seconds / self.period), float(mount[2]), tensions[self.gripper.model.lead]
            for k in range(steps):
                share = (k + 1) / steps
                mount[2] = begun + share * (aim - begun)
                tensions[self.gripper.model.lead] = before + share * (pulled - before)
                self._pull(tensions)
        return tensions

    def _pull(self, tensions: np.ndarray) -> np.ndarray:
        """Readings of all fingers at equal tensions, shape (fingers,) [N]."""
        felt = np.array([plant.pull(tensions) for plant in self.driven])
        self.look()
        return felt


def yield_to(gripper: Gripper, grips: list[Grip], gently: float, mount: np.ndarray) -> None:
    """Move the mount for a period to where the contact forces balance.

    Args:
        gripper: its directions are those of the mount.
        grips: of its fingers.
        gently: contact force at which fingers wait for each other [N].
        mount: its controls, of which the first two are changed [m].
    """
    felt = np.array([0.0 if grip.stage == "approach" else grip.felt for grip in grips])
    moved = mount[:2] + YIELDS * grips[0].period / gently * (felt @ gripper.directions)
    mount[:2] = moved * min(1.0, FARTHEST / max(float(np.linalg.norm(moved)), 1e-12))
