"""Fingers feel the table, and bend beside a solid; the arm yields to a finger that touches first."""

from __future__ import annotations

import numpy as np

from control.grasping.grasp_controller import Grip
from control.mujoco.table import closing_at
from studies.grasping.hand import RAISED, Hand
from studies.grasping.trials import PERIOD

GOES_DOWN = 0.03  # speed before the table is felt [m/s]
TOUCHES = 2  # readings in a row that are contact
BENDING, LOWERING = 0.4, 0.3  # how long it takes to bend beside the solid, and to go down [s]
BESIDE = 0.001  # distance of bent fingers from the solid [m]
YIELDS = 0.008  # speed of the arm at the contact force at which fingers wait for each other [m/s]
FARTHEST = 0.008  # most that the arm yields [m]


def feel_table(hand: Hand, feel: float) -> float:
    """Go down with open fingers until most of them feel the table.

    Args:
        hand: above the table.
        feel: contact force that counts as contact [N].

    Returns:
        Height of the arm at which the palm is on the table [m].
    """
    heights, touching, tensions = list[float](), 0, np.zeros_like(hand.simulation.wanted)
    while touching < TOUCHES:
        hand.mount[2] -= GOES_DOWN * PERIOD
        felt = hand.pull(tensions)
        hand.show()
        heights.append(hand.height)
        touching = touching + 1 if np.median(felt) > feel else 0
    late = TOUCHES - 1 + round(hand.driven[0].age / PERIOD)
    return heights[-1 - min(late, len(heights) - 1)] - closing_at(hand.gripper, hand.rod, hand.gripper.radius)[2]


def bend(hand: Hand, reach: float, palm: float) -> None:
    """Bend beside a solid, then go down to the height of the grasp.

    Args:
        hand: above the solid.
        reach: largest distance of the solid from the gripper's axis [m].
        palm: height of the arm for the grasp [m].
    """
    lead, tension = hand.gripper.model.lead, closing_at(hand.gripper, hand.rod, reach + BESIDE)[0]
    tensions = np.zeros_like(hand.simulation.wanted)
    for seconds, aim, pulled in ((BENDING, palm + RAISED, tension), (LOWERING, palm, tension)):
        steps, begun, before = round(seconds / PERIOD), float(hand.mount[2]), float(tensions[0, lead])
        for k in range(steps):
            share = (k + 1) / steps
            hand.mount[2] = begun + share * (aim - begun)
            tensions[:, lead] = before + share * (pulled - before)
            hand.pull(tensions)
            hand.show()


def yield_to(hand: Hand, grips: list[Grip], gently: float) -> None:
    """Move the arm for a period to where the contact forces of its fingers balance.

    It is for fingers that have not all touched yet: an arm that goes on takes their contact away.

    Args:
        hand: the gripper, not turned.
        grips: of its fingers.
        gently: contact force at which fingers wait for each other [N].
    """
    felt = np.array([0.0 if grip.stage == "approach" else grip.felt for grip in grips])
    moved = hand.mount[:2] + YIELDS * PERIOD / gently * (felt @ hand.gripper.directions)
    hand.mount[:2] = moved * min(1.0, FARTHEST / max(float(np.linalg.norm(moved)), 1e-12))
