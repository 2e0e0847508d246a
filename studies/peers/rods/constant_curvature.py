"""A finger that is an arc of constant curvature, as in most controllers of soft robots.

A tendon of tension F at y = e bends the arc by the couple F e and compresses it by F. Its curvature per deformed length
is F e/(E I).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from studies.peers.question import Answers, Finger, finger
from studies.peers.rods.asking import Rubber, answers, corners, tip

SCAN = 200  # steps from the free curvature to a straight finger, in which touch is looked for
STEP = 1e-6  # of a curvature, over the free one, for the arc's Jacobian [-]


@dataclass(frozen=True)
class Arc:
    """A finger with one unknown, its curvature."""

    finger: Finger

    def length(self, tension: float) -> float:
        """Of the arc, shortened by the tendon to first order [m]."""
        rubber = Rubber(self.finger)
        return rubber.length * (1 - tension / rubber.axial)

    def end(self, tension: float, curvature: float) -> tuple[float, float, float]:
        """The rubber's end: x, y [m] and its angle."""
        length = self.length(tension)
        angle = curvature * length
        share = np.sinc(angle / (2 * math.pi))  # sin(a/2)/(a/2), and 1 for a straight one
        return length * share * math.cos(angle / 2), length * share * math.sin(angle / 2), angle

    def solve(self, tension: float, distance: float | None) -> tuple[list[float], float]:
        """Tip [m] and contact force [N], by virtual work: the couple over the Jacobian of the plate's corner."""
        rubber = Rubber(self.finger)
        free = tension * self.finger.offset / rubber.bending
        plane = math.inf if distance is None else self.finger.side / 2 + distance

        def depth(curvature: float) -> float:
            return max(y for _, y in corners(self.finger, *self.end(tension, curvature))) - plane

        if depth(free) <= 0:
            return tip(self.finger, *self.end(tension, free)), 0.0
        step = free / SCAN
        outside = next(one for one in free - step * np.arange(1, SCAN + 1) if depth(one) < 0)
        held = brentq(depth, outside, outside + step)
        small = STEP * free
        jacobian = (depth(held + small) - depth(held - small)) / (2 * small)
        moment = rubber.bending * (free - held)
        return tip(self.finger, *self.end(tension, held)), self.length(tension) * moment / jacobian


def measure() -> Answers:
    """The arc's answers."""
    asked = finger()
    rubber = Rubber(asked)
    return answers(
        Arc(asked).solve,
        name="constant curvature",
        settings=f"contact force by virtual work; E I = {rubber.bending:.4g} N m², E A = {rubber.axial:.4g} N",
        limits="the shape is an arc under any contact; small strains, no shear",
    )
