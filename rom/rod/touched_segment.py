"""A finger that one object may touch: the model that controllers query, of tensions and the object's distance."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rom.answer import Answer
from rom.brief import brief
from rom.bundled import file_of
from rom.dataset.sections.section import top
from rom.native import LIBRARY
from rom.rod import compiled
from rom.rod.objects.shapes import RigidObject, facing_plane
from rom.rod.rod import Rod
from rom.rod.touched_rod import TouchedRod

SHIPPED = file_of(None)


@brief
@dataclass(frozen=True, kw_only=True)
class TouchedSegment(TouchedRod):
    """A finger of one or more segments, and a frictionless rigid object that may touch it anywhere.

    Attributes:
        rod: the finger.
        obstacle: the object that may touch the finger.
    """

    obstacle: RigidObject
    has_obstacle: bool = field(default=True, init=False)
    has_pad: bool = field(default=False, init=False)

    @classmethod
    def load(cls, path: str | Path | None = None) -> TouchedSegment:
        """Read a finger; it stands before the plane y = side/2 + d, d from 0 to the finger's length.

        Args:
            path: the file, or the name of a bundled finger, see `rom.bundled`; None reads the paper's.

        Raises:
            ModelError: the file is missing, damaged, of another format, or no finger of rod elements.

        Example:
            >>> model = TouchedSegment.load()
            >>> model.evaluate([30.0, 0.0, 0.010]).contact_force
        """
        rod = Rod.load(file_of(path))
        length = sum(rod.scene["geometry"]["segments"])
        return cls(rod=rod, obstacle=facing_plane(2 * top(rod.scene), (0.0, length)))

    @property
    def objects(self) -> tuple[RigidObject, ...]:
        """The obstacle alone."""
        return (self.obstacle,)

    @property
    def distance_names(self) -> list[str]:
        """Name of the parameter for the obstacle's distance."""
        return ["d"]

    @property
    def scene(self) -> dict[str, Any]:
        """The scene that the finger was trained on."""
        return self.rod.scene

    @property
    def direction(self) -> np.ndarray:
        """Unit vector along which d moves the object away, shape (3,) [-]."""
        return np.array(self.obstacle.numbers()["direction"])

    def rubber_gap(self, point: np.ndarray, wrenches: np.ndarray) -> float:
        """Smallest distance of the rubber from the object under wrenches, see `Rod.place` [m]; infinite if unknown."""
        given = np.array(point, float), compiled.loads(self.rod.struct, np.asarray(wrenches, float))
        memory = compiled.memory_of(self.rod.struct)
        return float(LIBRARY.functions.fingerfem_rubber_gap(self.touching, *map(compiled.pointer, given), memory))

    @property
    def native(self) -> dict[str, Any]:
        """The data that compiled controllers need."""
        return {"touching": self.touching}

    def outputs(self, points: np.ndarray) -> np.ndarray:
        """Tip [m], contact force [N] and touch distance [m], shape (n, 5), at points, shape (n, p)."""
        return self.answers(points).out

    def evaluate(self, parameters: ArrayLike, d: ArrayLike | None = None) -> Answer:
        """Tip, its orientation, contact force, touch distance and tendon shortenings at tensions [N] and d [m].

        Like `TouchedRod.evaluate`, but the arrays have no dimension for the objects.
        """
        answer = super().evaluate(parameters, d)
        error = {name: one if name == "tip" else one[..., 0][()] for name, one in answer.error.items()}
        force, touch = answer.contact_force[..., 0][()], answer.touch_distance[..., 0][()]
        return replace(answer, contact_force=force, touch_distance=touch, error=error)
