"""The layout of a gripper for a solid: number of fingers, and rotation of the solid relative to them."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import NamedTuple

import numpy as np

from control.grasping.grasp_forces import Targets
from control.grasping.gripper import Gripper
from control.model import Model
from control.motion import Limits
from control.mujoco.solids import POSE_ERROR, Solid
from rom.brief import brief

FINGERS = (2, 3, 4)  # of a gripper
# Added to the height of the grasp of curved or irregular solids [m].
HEIGHTS = (-0.004, -0.002, 0.0, 0.002, 0.004)
CURVED = ("sphere", "mesh")
LOWEST = 0.0075  # height above the largest error at which tilted plates are clear of the table [m]
PLANNED = 3  # best candidates by `Solid.room` of which contact forces are computed
TRIED = 24  # most of them, while none has contact forces


@brief
class Layout(NamedTuple):
    """A gripper for a solid.

    Attributes:
        gripper: with its number of fingers.
        solid: with the height of the grasp.
        turn: rotation of the solid about its axis, relative to the fingers [rad].
        targets: contact forces, or the reason why none exist.
    """

    gripper: Gripper
    solid: Solid
    turn: float
    targets: Targets

    @property
    def room(self) -> float:
        """Ratio of the forces at which the solid is crushed and dropped [-]."""
        return self.targets.most / self.targets.least


def best_layout(model: Model, solid: Solid, limits: Limits | None = None, margin: float = 0.1) -> Layout:
    """Return the layout with the largest ratio of the forces at which a solid is crushed and dropped.

    Numbers of fingers, rotations of the solid and, on curved faces, heights are compared. Open fingers must be clear of
    the solid, whatever the error of its position.

    Args:
        model: of every finger.
        solid: to be held.
        limits: of every finger's tensions and their rate.
        margin: admissible relative error of forces on both sides [-].
    """
    added = HEIGHTS if solid.shape in CURVED else (0.0,)
    heights = {max(solid.grasped + one, min(LOWEST + solid.uncertain[2], solid.grasped)) for one in added}
    candidates = list[tuple[float, int, Solid, float]]()  # estimated room, fingers, solid, rotation
    grippers = {fingers: Gripper(model, fingers, limits=limits) for fingers in FINGERS}
    for fingers, gripper in grippers.items():
        clear = gripper.radius - POSE_ERROR
        for height, turn in product(sorted(heights), solid.turns(fingers)):
            one = replace(solid, grasped=height)
            turned = one.turned(turn)
            room = turned.room(gripper.directions) if turned.reach(gripper.directions) < clear else -np.inf
            candidates.append((room, fingers, one, turn))
    candidates.sort(key=lambda one: -one[0])
    planned = list[Layout]()
    for _, fingers, one, turn in candidates[:TRIED]:
        if len(planned) >= PLANNED and any(layout.targets.exist for layout in planned):
            break
        planned.append(_planned(grippers[fingers], one, turn, margin))
    return max(planned, key=lambda one: (one.targets.exist, one.room))


def _planned(gripper: Gripper, solid: Solid, turn: float, margin: float) -> Layout:
    """A layout with its contact forces."""
    held = solid.turned(turn).held(gripper.directions)
    return Layout(gripper, solid, turn, gripper.targets(held, margin=margin))
