"""The layout of a gripper for a solid: number of fingers, and rotation of the solid relative to them."""

from __future__ import annotations

from typing import NamedTuple

from control.grasping.grasp_forces import Targets
from control.grasping.gripper import Gripper
from control.model import Model
from control.motion import Limits
from control.mujoco.solids import Solid
from rom.brief import brief

FINGERS = (2, 3, 4)  # of a gripper


@brief
class Layout(NamedTuple):
    """A gripper for a solid.

    Attributes:
        gripper: with its number of fingers.
        turn: rotation of the solid about its axis, relative to the fingers [rad].
        targets: contact forces, or the reason why none exist.
    """

    gripper: Gripper
    turn: float
    targets: Targets


def best_layout(model: Model, solid: Solid, limits: Limits | None = None, margin: float = 0.1) -> Layout:
    """Return the layout with the largest ratio of the forces at which a solid is crushed and dropped.

    Args:
        model: of every finger.
        solid: to be held.
        limits: of every finger's tensions and their rate.
        margin: admissible relative error of forces on both sides [-].
    """
    found = []
    for fingers in FINGERS:
        gripper = Gripper(model, fingers, limits=limits)
        turn = solid.best_turn(gripper.directions)
        held = solid.turned(turn).held(gripper.directions)
        found.append(Layout(gripper, turn, gripper.targets(held, margin=margin)))
    return max(found, key=lambda one: one.targets.most / one.targets.least)
