"""Fingers that wait for each other at a gentle touch, squeeze together, and judge what they hold."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from control import Gripper
from control.grasp_controller import Grip

GENTLY = 0.4  # of the held force, with which fingers wait for each other [-]
SQUEEZE = 0.3  # from there to the held force [s]


@dataclass
class Closing:
    """Contact forces that fingers are told, from touch to hold.

    Attributes:
        grips: their controllers.
        wanted: contact forces in the end, shape (fingers,) [N].
        share: of these that they are told now [-].
    """

    grips: list[Grip]
    wanted: np.ndarray
    share: float = GENTLY

    @property
    def ended(self) -> bool:
        """Whether they are told all and hold it, or one has given up."""
        given_up = any(grip.done and grip.status != "converged" for grip in self.grips)
        return given_up or (self.share >= 1.0 and all(grip.done for grip in self.grips))

    def targets(self) -> np.ndarray:
        """Contact forces from now on, shape (fingers,) [N]: all squeeze once all have touched."""
        if all(grip.stage == "hold" for grip in self.grips) or self.share > GENTLY:
            self.share = min(self.share + (1 - GENTLY) * self.grips[0].period / SQUEEZE, 1.0)
        return self.share * self.wanted

    def doubt(self, gripper: Gripper, radius: float, uncertain: float) -> str:
        """Why not to lift; empty if nothing speaks against it.

        Args:
            gripper: whose fingers.
            radius: half-width of what is grasped [m].
            uncertain: how far from where they should be its faces may be found [m].
        """
        failed = [f"finger {k}: {grip.status}" for k, grip in enumerate(self.grips) if grip.status != "converged"]
        if failed:
            return ", ".join(failed)
        off = np.array([grip.distance for grip in self.grips]) - (gripper.radius - radius)
        worst = int(np.argmax(np.abs(off)))
        if abs(off[worst]) > uncertain:
            return f"finger {worst} finds its face {1000 * abs(off[worst]):.1f} mm from where it should be"
        return ""
