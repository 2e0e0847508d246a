"""Rods that need no package: arcs of constant curvature, and the planar elastica that touches by its plate's edge.

Both have a guided tendon of tension F beside their axis, at y = e: it bends by the couple F e and compresses by F.
Both can be stretched along their axis and neither can be sheared. Numbers to check them by: an arc has the curvature
F e/(E I); a long elastica that is touched at its end obeys theta' = m - r (x_tip - x).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq, root

from studies.peers.question import Answers, Finger, finger
from studies.peers.rods.asking import UNREACHED, Rubber, answers, ask, corners, refined, tip

SCAN = 200  # steps from the free curvature back to a straight finger, on which an arc that touches is looked for
APPROACH = 10  # steps of the plane, from where an elastica is first touched to where it is
STEP = 1e-6  # of a curvature, over the free one, for the arc's Jacobian [-]
STEPS = (8, 16, 32, 64)  # of Runge and Kutta along the elastica; its error falls by 16 for half the step
TOLERANCE = 1e-10  # of forces over E I/L^2 and of places over L, when an elastica is solved for [-]

Pose = tuple[float, float, float]  # the rubber's end: x, y [m] and its angle


@dataclass(frozen=True)
class Arc:
    """A finger that can only be an arc: one unknown, its curvature.

    It is curved by F e/(E I) per length at rest, as in Reissner's beam theory, or per length of the arc as it is, which
    the tendon has shortened, as constant curvature is mostly written down.
    """

    finger: Finger
    per_rest_length: bool = False

    def end(self, tension: float, curvature: float) -> Pose:
        """Where an arc ends, shortened by the tendon to first order."""
        rubber = Rubber(self.finger)
        length = rubber.length * (1 - tension / rubber.axial)
        angle = curvature * self.curved(tension)
        share = np.sinc(angle / (2 * math.pi))  # sin(a/2)/(a/2), and 1 for a straight one
        return length * share * math.cos(angle / 2), length * share * math.sin(angle / 2), angle

    def curved(self, tension: float) -> float:
        """The length that its curvature is per unit of [m]."""
        rubber = Rubber(self.finger)
        return rubber.length * (1.0 if self.per_rest_length else 1 - tension / rubber.axial)

    def reach(self, tension: float, curvature: float) -> float:
        """How far the plate's corner is towards the plane [m]."""
        return max(y for _, y in corners(self.finger, *self.end(tension, curvature)))

    def solve(self, tension: float, distance: float | None) -> tuple[list[float], float]:
        """Tip [m] and contact force [N]; the force holds the arc back by virtual work, as by J^T f in robotics."""
        rubber = Rubber(self.finger)
        free = tension * self.finger.offset / rubber.bending
        plane = math.inf if distance is None else self.finger.side / 2 + distance

        def depth(curvature: float) -> float:
            return self.reach(tension, curvature) - plane

        if depth(free) <= 0:
            return tip(self.finger, *self.end(tension, free)), 0.0
        step = free / SCAN
        outside = next(way for way in free - step * np.arange(1, SCAN + 1) if depth(way) < 0)
        held = brentq(depth, outside, outside + step)
        small = STEP * free
        jacobian = (depth(held + small) - depth(held - small)) / (2 * small)
        moment = rubber.bending * (free - held)
        return tip(self.finger, *self.end(tension, held)), self.curved(tension) * moment / jacobian


@dataclass(frozen=True)
class Elastica:
    """A beam that can be stretched, and touched at its plate.

    Unknown are the contact force N and the x at which it acts; they are found so that the corner which touches is on
    the plane, or both are (the plate stands upright). Theirs is theta' = (F e - N (x_contact - x))/(E I), and the
    stretch -(F + N sin theta)/(E A).
    """

    finger: Finger
    steps: int

    def end(self, tension: float, force: float, where: float) -> Pose:
        """Where the rubber ends, by Runge and Kutta's fourth-order steps from the clamp."""
        rubber = Rubber(self.finger)
        couple = tension * self.finger.offset

        def slope(x: float, angle: float) -> tuple[float, float, float]:
            s = math.sin(angle)
            stretch = 1 - (tension + force * s) / rubber.axial
            return stretch * math.cos(angle), stretch * s, (couple - force * (where - x)) / rubber.bending

        x, y, angle = 0.0, 0.0, 0.0
        h = rubber.length / self.steps
        for _ in range(self.steps):
            a = slope(x, angle)
            b = slope(x + h / 2 * a[0], angle + h / 2 * a[2])
            c = slope(x + h / 2 * b[0], angle + h / 2 * b[2])
            d = slope(x + h * c[0], angle + h * c[2])
            x, y, angle = (old + h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]) for k, old in enumerate((x, y, angle)))
        return x, y, angle

    def solve(self, tension: float, distance: float | None) -> tuple[list[float] | None, float | None]:
        """Tip [m] and contact force [N]: pulled in free space first, then the plane comes, from where it touches."""
        free = self.end(tension, 0.0, 0.0)
        reach = self._reach(free)
        plane = math.inf if distance is None else self.finger.side / 2 + distance
        if reach <= plane:
            return tip(self.finger, *free), 0.0
        found = 0.0, max(corners(self.finger, *free), key=lambda corner: corner[1])[0]
        for between in np.linspace(reach, plane, APPROACH + 1)[1:]:
            ways = (self._held(tension, between, touching, found) for touching in self._touching())
            held = next((way for way in ways if way), None)
            if held is None:
                return UNREACHED
            found = held
        return tip(self.finger, *self.end(tension, *found)), found[0]

    def _reach(self, pose: Pose) -> float:
        return max(y for _, y in corners(self.finger, *pose))

    def _touching(self) -> tuple[Callable, ...]:
        """What is off, of every way to touch: as of `_upright`."""
        return self._by_corner(0), self._by_corner(1), self._upright

    def _by_corner(self, corner: int) -> Callable[[Pose, float, float], tuple[float, float]]:
        """One corner is on the plane, and the force acts there."""

        def wrong(pose: Pose, where: float, plane: float) -> tuple[float, float]:
            x, y = corners(self.finger, *pose)[corner]
            return y - plane, x - where

        return wrong

    def _upright(self, pose: Pose, where: float, plane: float) -> tuple[float, float]:
        """Both corners are on the plane, and the force acts between them."""
        (_, one), (_, other) = corners(self.finger, *pose)
        return one - plane, other - plane

    def _held(self, tension: float, plane: float, wrong: Callable, near: tuple[float, float]) -> tuple | None:
        """Force and place of one way to touch, None if there is none or it is not this state's."""
        rubber = Rubber(self.finger)
        unit = rubber.bending / rubber.length**2

        def scaled(z: np.ndarray) -> list[float]:
            where = z[1] * rubber.length
            return [way / rubber.length for way in wrong(self.end(tension, z[0] * unit, where), where, plane)]

        found = root(scaled, [near[0] / unit, near[1] / rubber.length], tol=TOLERANCE)
        force, where = found.x[0] * unit, found.x[1] * rubber.length
        pose = self.end(tension, force, where)
        places = [x for x, _ in corners(self.finger, *pose)]
        outside = max(min(places) - where, where - max(places), self._reach(pose) - plane)
        true = max(abs(off) for off in scaled(found.x)) < 1e-8 and force > 0 and outside < 1e-8 * rubber.length
        return (force, where) if true else None


def measure(quick: bool = False) -> list[Answers]:
    """All of them; there is no shorter form."""
    asked = finger()
    rubber = Rubber(asked)
    numbers = f"E I = {rubber.bending:.4g} N m², E A = {rubber.axial:.4g} N, rubber of {1000 * rubber.length:g} mm"
    arcs = {
        "constant curvature": ("as shortened by F/(E A)", False),
        "constant curvature, rest length": ("at rest", True),
    }
    curved = [
        answers(
            {
                "name": name,
                "kind": "beam",
                "settings": f"curvature F e/(E I) per length {per}; contact force by virtual work; {numbers}",
                "limits": "an arc whatever touches it, small strains, no shear, no deformation of the section",
            },
            ask(Arc(asked, at_rest).solve),
        )
        for name, (per, at_rest) in arcs.items()
    ]
    told = [ask(Elastica(asked, steps).solve) for steps in STEPS]
    elastica = {
        "name": "planar elastica",
        "kind": "beam",
        "settings": (
            f"curvature per length at rest, shooting by {STEPS[-2]} steps of Runge and Kutta, touched at the plate's "
            f"corners; {numbers}"
        ),
        "limits": "bends in its plane alone, small strains, no shear, no deformation of the section",
    }
    rows = refined([{"steps": steps} for steps in STEPS], told)
    return [*curved, answers(elastica, told[-2], rows)]
