"""The layout of a gripper for a solid: how many fingers stand around it, and how it is turned against them."""

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
        gripper: with so many fingers.
        turn: of the solid about its axis, against the fingers [rad].
        targets: contact forces, or why there are none.
    """

    gripper: Gripper
    turn: float
    targets: Targets


def best_layout(model: Model, solid: Solid, limits: Limits | None = None, margin: float = 0.1) -> Layout:
    """The layout whose contact forces may be off most, in ratio, before a solid is dropped or crushed.

    Args:
        model: of every finger.
        solid: to be held.
        limits: of every finger's tensions and of their rate.
        margin: that forces may be off on both sides [-].
    """
    found = []
    for fingers in FINGERS:
        gripper = Gripper(model, fingers, limits=limits)
        turn = solid.best_turn(gripper.directions)
        held = solid.turned(turn).held(gripper.directions)
        found.append(Layout(gripper, turn, gripper.targets(held, margin=margin)))
    return max(found, key=lambda one: one.targets.most / one.targets.least)
