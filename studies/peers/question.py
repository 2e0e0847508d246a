"""Common problem of all alternatives: the paper's finger, pulled by F1 alone, in free space and against the plane.

Any Python can import this module; numbers are those of scenes/one_segment.toml. The finger lies along x and is clamped
at x = 0, its section is a square centred on the axis, the tendon runs at y = offset, and the plane is y = side/2 + d.
"""

from __future__ import annotations

import time
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

SCENE = Path(__file__).resolve().parents[2] / "scenes" / "one_segment.toml"
# Tensions in free space [N]; tensions and distances in contact [N], [m]: from a light touch to a strong press.
FREE = (20.0, 40.0, 60.0, 80.0, 100.0)
CONTACT = (
    (20.0, 0.010),
    (30.0, 0.010),
    (40.0, 0.005),
    (40.0, 0.016),
    (60.0, 0.010),
    (60.0, 0.020),
    (80.0, 0.015),
    (80.0, 0.025),
    (100.0, 0.027),
)


# Tip [m], shape (3,), and contact force [N] by a tension [N] and a distance of the plane [m], None for free space.
Ask = Callable[[float, float | None], tuple[list[float] | None, float | None]]


@dataclass(frozen=True, kw_only=True)
class Finger:
    """Lengths of the finger [m] (`length` from clamp to tip, plate included) and constants C1 [Pa], D1 [1/Pa]."""

    length: float
    side: float
    plate: float
    offset: float
    C1: float
    D1: float

    @property
    def young(self) -> float:
        """Young's modulus at small strains [Pa]."""
        return 2 * self.shear * (1 + self.poisson)

    @property
    def shear(self) -> float:
        """[Pa]."""
        return 2 * self.C1

    @property
    def poisson(self) -> float:
        """Poisson's ratio of small strains [-]."""
        bulk = 2 / self.D1
        return (3 * bulk - 2 * self.shear) / (2 * (3 * bulk + self.shear))


def finger() -> Finger:
    """The finger of the scene's file."""
    scene = tomllib.loads(SCENE.read_text())
    shape, material = scene["geometry"], scene["material"]
    return Finger(
        length=shape["segments"][0],
        side=shape["side"],
        plate=shape["plate"],
        offset=scene["tendons"][0]["offset"][0],
        C1=material["C1"],
        D1=material["D1"],
    )


@dataclass(frozen=True, kw_only=True)
class Answers:
    """Answers of one alternative, None where it has none: tips, shape (states, 3) [m], forces [N], core-seconds."""

    name: str
    kind: str
    free_tips: Sequence[Sequence[float] | None]
    contact_tips: Sequence[Sequence[float] | None]
    contact_forces: Sequence[float | None]
    seconds: float
    settings: str
    limits: str

    def as_json(self) -> dict[str, Any]:
        """Plain data for a part's file."""
        return asdict(self)


def answers(ask: Ask, kind: str = "beam", repeats: int = 1, **words: str) -> Answers:
    """Answers to every state of the question, timed; `words` are name, settings and limits."""
    states = [*((tension, None) for tension in FREE), *CONTACT]
    begun = time.process_time()
    for _ in range(repeats):
        found = [ask(tension, distance) for tension, distance in states]
    return Answers(
        **words,
        kind=kind,
        free_tips=[tip for tip, _ in found[: len(FREE)]],
        contact_tips=[tip for tip, _ in found[len(FREE) :]],
        contact_forces=[force for _, force in found[len(FREE) :]],
        seconds=(time.process_time() - begun) / len(found) / repeats,
    )
