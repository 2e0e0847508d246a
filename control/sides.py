"""The sides of a finger on which its actuators pull: the scene's own, or those of imagined mirror images."""

from collections.abc import Mapping
from typing import Any

import numpy as np


class Sides:
    """Along y and z: 1 of the scene's own actuators, -1 of their mirror images.

    Args:
        scene: with the tendons and chambers, as plain data.
    """

    def __init__(self, scene: Mapping[str, Any]):
        # A tension bends the finger to the side of its tendon, a pressure away from its chamber.
        pulls = [tendon["offset"] for tendon in scene["tendons"]]
        pushes = [[-part for part in chamber["centre"]] for chamber in scene.get("chambers") or []]
        self._bends = np.array(pulls + pushes, float)

    def wanted(self, goal: np.ndarray, distance: float) -> tuple[int, int]:
        """-1 if the goal lies opposite the actuators and their mirror images may reach it, else 1.

        Args:
            goal: of the tip, shape (3,) [m].
            distance: of a plane, which breaks the symmetry in y [m]; infinite without one.
        """
        return (
            -1 if goal[1] < 0 and not np.isfinite(distance) and self._mirrors(0) else 1,
            -1 if goal[2] < 0 and self._mirrors(1) else 1,
        )

    def changed(self, present: np.ndarray, sides: tuple[int, int], wanted: tuple[int, int]) -> tuple[int, int]:
        """The next sides: they change only while their actuators are slack, so that none is released suddenly.

        Args:
            present: loads, shape (loads,) [N, Pa].
            sides: now.
            wanted: see `wanted`.
        """
        loaded = [bool(np.any(present[self._bends[:, a] != 0] > 0)) for a in (0, 1)]
        y, z = (old if busy else new for busy, old, new in zip(loaded, sides, wanted, strict=True))
        return y, z

    def _mirrors(self, axis: int) -> bool:
        """True if the scene's own actuators bend the finger to one side only."""
        return bool(np.all(self._bends[:, axis] >= 0))
