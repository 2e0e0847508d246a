"""What all rods share: the steel plate at their end, where it touches the plane, and how their answers are collected.

The finger bends in its plane x, y, pulled towards +y. A rod ends where the rubber ends, at length - plate from the
clamp, at an angle to the x axis; the plate goes straight on from there.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from studies.peers.question import CONTACT, FREE, Answers, Finger

# Of a tension [N] and a distance of the plane [m], None for free space: tip [m], shape (3,), and contact force [N].
Solve = Callable[[float, float | None], tuple[list[float] | None, float | None]]
UNREACHED = (None, None)  # what is answered where a method has not come to its tolerance


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
    """The two far corners of the plate [m]: of its side at +y, and of its side at -y, both as at rest.

    As the plate is tilted by 0 to 180 degrees, one of them comes closest to the plane; at 90 degrees both.
    """
    c, s = math.cos(angle), math.sin(angle)
    end = x + finger.plate * c, y + finger.plate * s
    half = finger.side / 2
    return [(end[0] - half * s, end[1] + half * c), (end[0] + half * s, end[1] - half * c)]


@dataclass(frozen=True, kw_only=True)
class Told:
    """All answers at one resolution: tips [m], forces [N], core-seconds per answer."""

    free: list[list[float] | None]
    touching: list[list[float] | None]
    forces: list[float | None]
    seconds: float

    def apart(self, finest: Told) -> dict[str, float | None]:
        """Relative differences to the finest: largest of tips (over the tip's way), median and largest of forces [-].

        The largest is of the lightest touch, whose force is a small difference.
        """
        ways = _relative(self.free + self.touching, finest.free + finest.touching)
        forces = _relative(self.forces, finest.forces)
        return {
            "tip": max(ways, default=None),
            "contact_force": float(np.median(forces)) if forces else None,
            "contact_force_max": max(forces, default=None),
        }


def ask(solve: Solve) -> Told:
    """Every state of the question, timed."""
    begun = time.process_time()
    free = [solve(tension, None)[0] for tension in FREE]
    touching = [solve(tension, distance) for tension, distance in CONTACT]
    seconds = (time.process_time() - begun) / (len(FREE) + len(CONTACT))
    return Told(
        free=free, touching=[way for way, _ in touching], forces=[force for _, force in touching], seconds=seconds
    )


def answers(words: dict[str, str], told: Told, refinement: list[dict[str, Any]] | None = None) -> Answers:
    """For the contract; `words` are its name, kind, settings and limits."""
    return Answers(
        **words,
        free_tips=told.free,
        contact_tips=told.touching,
        contact_forces=told.forces,
        seconds=told.seconds,
        refinement=refinement or [],
    )


def refined(resolutions: Sequence[dict[str, Any]], told: Sequence[Told]) -> list[dict[str, Any]]:
    """A table's rows: each resolution, how far its answers are from the last one's, what an answer costs."""
    rows = zip(resolutions, told, strict=True)
    return [{**words, **one.apart(told[-1]), "seconds": one.seconds} for words, one in rows]


def _relative(one: Sequence, other: Sequence) -> list[float]:
    """Of what both have an answer to, and the other is not zero."""
    both = [(np.ravel(a), np.ravel(b)) for a, b in zip(one, other, strict=True) if a is not None and b is not None]
    return [float(np.linalg.norm(a - b) / np.linalg.norm(b)) for a, b in both if np.any(b)]
