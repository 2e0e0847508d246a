"""Part `beams`: an arc of constant curvature, as in most controllers of soft robots, and a Cosserat rod.

The finger bends in its plane x, y, pulled towards +y. A beam ends where the rubber ends, at length - plate from the
clamp, at an angle to the x axis; the plate goes straight on from there, and its far corners touch the plane.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, root

from studies.parts import Run
from studies.peers.question import Finger, answers, finger

SCAN = 200  # steps from the free curvature to a straight finger, in which touch is looked for
STEP = 1e-6  # of a curvature, over the free one, for the arc's Jacobian [-]
SHEAR_FACTOR = 5 / 6  # of a rectangle
TOLERANCE = 1e-10  # of the rod's integration, and of its tendon's direction

End = tuple[float, float, float]  # of the rubber: x, y [m] and its angle


class Rubber:
    """The finger as a beam: stiffnesses E A, k G A [N] and E I [N m^2], and the length of its rubber [m]."""

    def __init__(self, finger: Finger):
        self.length = finger.length - finger.plate
        self.axial = finger.young * finger.side**2
        self.shear = SHEAR_FACTOR * finger.shear * finger.side**2
        self.bending = finger.young * finger.side**4 / 12


def tip(finger: Finger, end: End) -> list[float]:
    """Displacement of the plate's centre [m]."""
    x, y, angle = end
    half = finger.plate / 2
    return [x + half * math.cos(angle) - (finger.length - half), y + half * math.sin(angle), 0.0]


def corner(finger: Finger, end: End) -> tuple[float, float]:
    """Position x, y of the higher one of the plate's two far corners [m]."""
    c, s = math.cos(end[2]), math.sin(end[2])
    half = math.copysign(finger.side / 2, c)
    return end[0] + finger.plate * c - half * s, end[1] + finger.plate * s + half * c


def plane_of(finger: Finger, distance: float | None) -> float:
    """Height of the plane [m]."""
    return math.inf if distance is None else finger.side / 2 + distance


@dataclass(frozen=True)
class Arc:
    """A finger with one unknown, its curvature; a tendon bends it by the couple F e, and compresses it by F."""

    finger: Finger

    def length(self, tension: float) -> float:
        """Length of the arc, shortened by the tendon to first order [m]."""
        rubber = Rubber(self.finger)
        return rubber.length * (1 - tension / rubber.axial)

    def end(self, tension: float, curvature: float) -> End:
        """The rubber's end; the curvature is per deformed length [1/m]."""
        length = self.length(tension)
        angle = curvature * length
        share = np.sinc(angle / (2 * math.pi))  # sin(a/2)/(a/2), and 1 for a straight one
        return length * share * math.cos(angle / 2), length * share * math.sin(angle / 2), angle

    def solve(self, tension: float, distance: float | None) -> tuple[list[float], float]:
        """Tip [m] and contact force [N], by virtual work: the couple over the Jacobian of the plate's corner."""
        rubber, plane = Rubber(self.finger), plane_of(self.finger, distance)
        free = tension * self.finger.offset / rubber.bending

        def depth(curvature: float) -> float:
            return corner(self.finger, self.end(tension, curvature))[1] - plane

        if depth(free) <= 0:
            return tip(self.finger, self.end(tension, free)), 0.0
        step = free / SCAN
        outside = next(one for one in free - step * np.arange(1, SCAN + 1) if depth(one) < 0)
        held = brentq(depth, outside, outside + step)
        small = STEP * free
        jacobian = (depth(held + small) - depth(held - small)) / (2 * small)
        moment = rubber.bending * (free - held)
        return tip(self.finger, self.end(tension, held)), self.length(tension) * moment / jacobian


@dataclass(frozen=True)
class CosseratRod:
    """A rod that stretches, shears and bends, with the tendon's length times its tension in its energy.

    D. C. Rucker and R. J. Webster III, IEEE Trans. Robotics 27, 2011, in the plane. Per length at rest, with stretch v,
    shear g, curvature k and the tendon's direction (v - e k, g) in the section's frame:
    W = E A (v - 1)^2 / 2 + k G A g^2 / 2 + E I k^2 / 2 + F |(v - e k, g)|.
    """

    finger: Finger

    def strains(self, tension: float, force: tuple[float, float], moment: float) -> tuple[float, float, float]:
        """Stretch, shear and curvature under a force in the section's frame [N] and a moment [N m]."""
        rubber, direction, before = Rubber(self.finger), 0.0, math.inf
        while abs(direction - before) > TOLERANCE:
            along, across = tension * math.cos(direction), tension * math.sin(direction)
            stretch = 1 + (force[0] - along) / rubber.axial
            shear = (force[1] - across) / rubber.shear
            curvature = (moment + self.finger.offset * along) / rubber.bending
            before, direction = direction, math.atan2(shear, stretch - self.finger.offset * curvature)
        return stretch, shear, curvature

    def end(self, tension: float, pressed: float = 0.0, arm: float = 0.0) -> End:
        """The rubber's end where a plane pushes down by a force [N] on a corner at x = arm [m]."""

        def slope(_: float, at: np.ndarray) -> list[float]:
            c, s = math.cos(at[2]), math.sin(at[2])
            stretch, shear, curvature = self.strains(tension, (-pressed * s, -pressed * c), -pressed * (arm - at[0]))
            return [stretch * c - shear * s, stretch * s + shear * c, curvature]

        length = Rubber(self.finger).length
        x, y, angle = solve_ivp(slope, (0.0, length), np.zeros(3), rtol=TOLERANCE, atol=TOLERANCE).y[:, -1]
        return float(x), float(y), float(angle)

    def solve(self, tension: float, distance: float | None) -> tuple[list[float] | None, float | None]:
        """Tip [m] and contact force [N]; None if none was found."""
        rubber, plane = Rubber(self.finger), plane_of(self.finger, distance)
        free = self.end(tension)
        at = corner(self.finger, free)
        if at[1] <= plane:
            return tip(self.finger, free), 0.0
        length, stiffness = rubber.length, 3 * rubber.bending / rubber.length**3

        def apart(unknown: np.ndarray) -> list[float]:
            force, arm = unknown * [stiffness * length, length]
            x, y = corner(self.finger, self.end(tension, force, arm))
            return [(x - arm) / length, (y - plane) / length]

        found = root(apart, [(at[1] - plane) / length, at[0] / length], tol=TOLERANCE)
        if not found.success:
            return None, None
        force, arm = (found.x * [stiffness * length, length]).tolist()
        return tip(self.finger, self.end(tension, force, arm)), force


def measure(run: Run) -> list[dict]:
    """The answers of both."""
    asked = finger()
    moduli = f"E I = {Rubber(asked).bending:.4g} N m², E A = {Rubber(asked).axial:.4g} N"
    arc = answers(
        Arc(asked).solve,
        name="constant curvature",
        settings=f"contact force by virtual work; {moduli}",
        limits="the shape is an arc under any contact; small strains, no shear",
    )
    rod = answers(
        CosseratRod(asked).solve,
        name="Cosserat rod",
        settings=f"shooting with SciPy's Runge-Kutta method; {moduli}, shear factor 5/6",
        limits="stresses are linear in strain, and sections neither warp nor change their size",
    )
    return [arc.as_json(), rod.as_json()]
