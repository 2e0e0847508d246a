"""A touched segment and, behind it, the surrogate of the same finger before the same plane.

The segment's map knows nothing of rubber that touches, nor of forces beyond those it was trained with. The surrogate
does, of its one plane; it is asked wherever the map's answer is not inside. Between the two a contact force changes by
what they err.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from rom.brief import brief
from rom.checked_file import ModelError
from rom.native import PickledByFields
from rom.native.answer import Answer
from rom.rod.objects.shapes import Plane, facing_plane
from rom.rod.rod import QUANTITIES
from rom.rod.touched_segment import TouchedSegment

if TYPE_CHECKING:  # segments are below the surrogate, which is only asked
    from rom.surrogate import Surrogate

VALUES = "tip", "contact_force", "touch_distance", "inside"  # of an answer
# Of an answer, what a surrogate does not have: nan, with an infinite error.
ONLY_TOUCHED = "orientation", "orientation_error", "shortenings", "shortening_error"
SAME = ("geometry", "material", "mesh")  # parts of a scene that both were trained with


@brief
@dataclass(frozen=True, kw_only=True)
class BackedSegment(PickledByFields):
    """A model of tensions and a plane's distance: a segment's map, with a surrogate for what the map does not know.

    Attributes:
        touched: the segment before the plane y = side/2 + d.
        surrogate: of the same finger before that plane.

    Raises:
        ModelError: the two are not of one finger, or the object is another.
    """

    touched: TouchedSegment
    surrogate: Surrogate
    has_obstacle: bool = field(default=True, init=False)
    has_pad: bool = field(default=False, init=False)

    def __post_init__(self) -> None:
        one, other, obstacle = self.touched.scene, self.surrogate.scene, self.touched.obstacle
        for name in SAME:
            if one[name] != other[name]:
                raise ModelError(f"surrogate must be of the map's {name}, got {other[name]} and {one[name]}")
        if [_tendon(each) for each in one["tendons"]] != [_tendon(each) for each in other["tendons"]]:
            raise ModelError("surrogate must be of the map's tendons, got others")
        plane = facing_plane(one["geometry"]["side"], obstacle.distances)
        faced = isinstance(obstacle, Plane) and obstacle.numbers() == plane.numbers()
        if not faced or not self.surrogate.has_obstacle or other["obstacle"].get("shape", "plane") != "plane":
            raise ModelError("both must stand before the plane y = side/2 + d, got another object or none")

    @property
    def parameters(self) -> list[dict[str, Any]]:
        """Name, unit, lower and upper of tensions and d."""
        return self.touched.parameters

    @property
    def limits(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper ends of the parameters, shapes (p,) [N, m]."""
        return self.touched.limits

    @property
    def lead(self) -> int:
        """The tension that pushes most towards the plane."""
        return self.touched.lead

    @property
    def scene(self) -> dict[str, Any]:
        """The segment's trained scene."""
        return self.touched.scene

    @property
    def native(self) -> dict[str, Any]:
        """What compiled controllers ask: the segment, then the surrogate."""
        return self.surrogate.native | self.touched.native

    def outputs(self, points: np.ndarray) -> np.ndarray:
        """Tip [m], contact force [N] and touch distance [m], shape (n, 5), at points, shape (n, p)."""
        found = self.touched.answers(points)
        unknown = ~found.inside
        found.out[unknown] = self.surrogate.outputs(np.asarray(points, float)[unknown])[:, :5]
        return found.out

    def evaluate(self, parameters: ArrayLike) -> Answer:
        """Tip, contact force and touch distance at tensions [N] and d [m], shape (p,) or (n, p).

        Raises:
            ModelError: the wrong number of parameters.
        """
        points = np.atleast_2d(np.asarray(parameters, float))
        found = self.touched.evaluate(points)
        unknown = ~found.inside
        behind = self.surrogate.evaluate(points[unknown])
        values: dict[str, Any] = {name: getattr(found, name) for name in VALUES}
        for name, value in values.items():
            value[unknown] = getattr(behind, name)
        for name in ONLY_TOUCHED:
            values[name] = getattr(found, name)
            values[name][unknown] = np.inf if name.endswith("error") else np.nan
        parts: dict[str, dict[str, Any]] = {}
        for of in dict.fromkeys([*found.error_parts, *behind.error_parts]):
            # A part that one of the two does not have is 0 of its error.
            front, back = (answer.error_parts.get(of, {}) for answer in (found, behind))
            parts[of] = {name: np.array(front.get(name, np.zeros(len(points)))) for name in QUANTITIES}
            for name, error in parts[of].items():
                error[unknown] = back.get(name, 0.0)
        if np.ndim(parameters) == 1:
            values = {name: value[0] for name, value in values.items()}
            parts = {of: {name: error[0] for name, error in part.items()} for of, part in parts.items()}
        values["error"] = {name: sum(part[name] for part in parts.values()) for name in QUANTITIES}
        return replace(found, **values, error_parts=parts)

    def jacobian(self, parameters: ArrayLike) -> np.ndarray:
        """Derivatives of the outputs at one point, shape (5, p)."""
        found = self.touched.answers(parameters)
        return found.jacobians[0] if found.inside[0] else self.surrogate.jacobian(parameters)[:5]


def _tendon(table: dict[str, Any]) -> tuple[Any, ...]:
    """What makes it the same one: not how far it is pulled."""
    return table["name"], table["path"], tuple(table["offset"]), table["segment"]
