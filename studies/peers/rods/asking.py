"""What all rods share: the steel plate at their end, its corners, and the question with its time.

The finger bends in its plane x, y, pulled towards +y. A rod ends where the rubber ends, at length - plate from the
clamp, at an angle to the x axis; the plate goes straight on from there.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

from studies.peers.question import CONTACT, FREE, Answers, Finger

# Of a tension [N] and a distance of the plane [m], None for free space: tip [m], shape (3,), and contact force [N].
Solve = Callable[[float, float | None], tuple[list[float] | None, float | None]]


@dataclass(frozen=True)
class Rubber:
    """The finger as a beam: E A [N], E I [N m^2], and the length of its rubber [m]."""

    finger: Finger

    @property
    def length(self) -> float:
        """From the clamp to the plate [m]."""
        return self.finger.length - self.finger.plate

    @property
    def axial(self) -> float:
        """E A [N]."""
        return self.finger.young * self.finger.side**2

    @property
    def bending(self) -> float:
        """E I of the square section [N m^2]."""
        return self.finger.young * self.finger.side**4 / 12


def tip(finger: Finger, x: float, y: float, angle: float) -> list[float]:
    """Displacement of the plate's centre [m], the rubber's end being at x, y [m] and at an angle."""
    half = finger.plate / 2
    return [x + half * math.cos(angle) - (finger.length - half), y + half * math.sin(angle), 0.0]


def corners(finger: Finger, x: float, y: float, angle: float) -> list[tuple[float, float]]:
    """The two far corners of the plate [m]: of its side at +y, and of its side at -y, both as at rest."""
    c, s = math.cos(angle), math.sin(angle)
    end = x + finger.plate * c, y + finger.plate * s
    half = finger.side / 2
    return [(end[0] - half * s, end[1] + half * c), (end[0] + half * s, end[1] - half * c)]


def answers(solve: Solve, **words: str) -> Answers:
    """Every state of the question, timed; `words` are name, settings and limits."""
    begun = time.process_time()
    free = [solve(tension, None)[0] for tension in FREE]
    pressed = [solve(tension, distance) for tension, distance in CONTACT]
    return Answers(
        **words,
        kind="beam",
        free_tips=free,
        contact_tips=[displacement for displacement, _ in pressed],
        contact_forces=[force for _, force in pressed],
        seconds=(time.process_time() - begun) / (len(FREE) + len(CONTACT)),
    )
