"""A finger of rod elements before one object, as a source of a table: as many samples as wanted, in seconds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from rom.brief import brief
from rom.rod.objects.shapes import facing_plane
from rom.rod.rod import QUANTITIES
from rom.rod.touched_segment import TouchedSegment
from rom.separated.alternating_directions import EnrichmentOptions
from rom.separated.model import SeparatedModel
from rom.separated.table_errors import Truth, compared, with_errors
from rom.separated.tabulated import NODES, Sampled, tabulated
from rom.terminal import Progress, quiet

CALIBRATING, MEASURING = 30_000, 8_000  # random points that calibrate the estimated errors; others that measure them
FEWEST = 20  # of the latter with a contact force inside
BEYOND = 2.0  # forces over the largest trained one up to which answers support a table [-]


@brief
@dataclass(frozen=True)
class RodSource:
    """A finger and its object, which a table samples."""

    model: TouchedSegment
    has_pad: ClassVar[bool] = False
    modes: ClassVar[None] = None

    @property
    def parameters(self) -> list[dict[str, Any]]:
        """Name, unit, lower and upper of tensions and d."""
        return self.model.parameters

    @property
    def scene(self) -> dict[str, Any]:
        """The finger's."""
        return self.model.scene

    @property
    def lead(self) -> int:
        """The tension that pushes most towards the object."""
        return self.model.lead

    def sampled(self, points: np.ndarray) -> Sampled:
        """Answers at points, shape (n, p), wherever the object is."""
        at = points[np.isfinite(points[:, -1]), -1]
        everywhere = (float(at.min()), float(at.max())) if at.size else self.model.obstacle.distances
        found = replace(self.model, obstacle=replace(self.model.obstacle, distances=everywhere)).answers(points)
        supports = (found.evaluations > 0) & (found.out[:, 3] < BEYOND * self.model.rod.force)
        return Sampled(found.out, found.jacobians, supports)

    def truth(self, random: np.random.Generator, count: int) -> Truth:
        """Answers at random points within the limits, with the finger's own estimated errors."""
        lower, upper = self.model.limits
        points = lower + random.random((count, len(lower))) * (upper - lower)
        answer = self.model.evaluate(points)
        out = np.column_stack([answer.tip, answer.contact_force, answer.touch_distance])
        errors = np.column_stack([answer.error[name] for name in QUANTITIES])
        return Truth(points, out, errors, np.asarray(answer.inside, bool))


def specialise(
    model: TouchedSegment,
    nodes: int = NODES,
    options: EnrichmentOptions | None = None,
    *,
    seed: int = 0,
    progress: Progress = quiet,
) -> SeparatedModel:
    """The table of a finger before its object, for tensions and d within the finger's limits.

    It states its error against the finger at random points. Estimated errors count the finger's own, and cells in which
    the finger has no answer within its limits are marked.

    Args:
        model: the finger and its object.
        nodes: of every axis, 4 at least; nodes^(tensions + 1) contacts are solved.
        options: of the separation.
        seed: of the points at which errors are measured.
        progress: called with the step, how much of it is done, and how much it is.

    Raises:
        ValueError: fewer than 4 nodes, or an object that is not in the way of the finger.

    Example:
        >>> table = specialise(TouchedSegment.load(), nodes=12)  # doctest: +SKIP
    """
    source = RodSource(model)
    table = tabulated(source, nodes, options, progress)
    progress("measuring the errors", 0, 2)
    table = with_errors(table, source.truth(np.random.default_rng([seed, 0]), CALIBRATING))
    progress("measuring the errors", 1, 2)
    measured = compared(table, source.truth(np.random.default_rng([seed, 1]), MEASURING))
    if measured["contact_force"]["count"] < FEWEST:
        raise ValueError(
            f"the table must have contact forces at {FEWEST} of {MEASURING} points at least, got "
            f"{measured['contact_force']['count']}: all others are marked; take other distances or more nodes"
        )
    plane = facing_plane(model.scene["geometry"]["side"], model.obstacle.distances)
    origin = {
        "specialised_from": model.scene["name"],
        "object": repr(model.obstacle),
        "facing_plane": model.obstacle == plane,
    }
    return replace(table, accuracy=measured, provenance=table.provenance | origin)
