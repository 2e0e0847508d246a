"""Names beside the points of a picture, where they hide neither points nor each other."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Annotation, Text
from matplotlib.transforms import Bbox

# Where a label may stand: directions, nearest distance first [pt]; a line leads to those that stand far off.
DISTANCES = (8, 16, 28, 42, 58, 76, 96, 120)
DIRECTIONS = ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1), (2, 1), (2, -1), (-2, 1), (-2, -1))
FAR = 10  # [pt]
POINT = 11  # half the size of what is kept free about a point [px]


def label(axes: Axes, points: list[tuple[float, float]], names: list[str], **text: Any) -> None:
    """Write names beside points of axes whose limits are set; those in the thick of it first.

    Raises:
        ValueError: for a name no room is left.
    """
    assert isinstance(axes.figure, Figure)
    axes.figure.draw_without_rendering()
    pixels = axes.transData.transform(points)
    taken = [Bbox.from_bounds(x - POINT, y - POINT, 2 * POINT, 2 * POINT) for x, y in pixels]
    crowded = np.argsort([np.sort(np.linalg.norm(pixels - at, axis=1))[: min(4, len(points))].sum() for at in pixels])
    room = axes.get_window_extent()
    for k in crowded:
        for distance, (right, up) in itertools.product(DISTANCES, DIRECTIONS):
            written = _write(axes, points[k], names[k], (right * distance, up * distance), **text)
            box = extent(written)
            if _within(box, room) and not any(box.overlaps(other) for other in taken):
                taken.append(box)
                break
            written.remove()
        else:
            raise ValueError(f"labels must have room beside their points, got none for {names[k]!r}")


def extent(written: Annotation) -> Bbox:
    """Of the letters, without the line that leads to them [px]."""
    written.get_window_extent()  # places the letters
    return Text.get_window_extent(written)


def _write(axes: Axes, point: tuple[float, float], name: str, offset: tuple[float, float], **text: Any) -> Annotation:
    """One label, with a line to its point if it is far off."""
    right, up = offset
    leads: dict[str, Any] = (
        {"arrowprops": {"arrowstyle": "-", "color": "0.6", "lw": 0.8}} if max(abs(right), abs(up)) > FAR else {}
    )
    sides = {-1: "right", 0: "center", 1: "left"}, {-1: "top", 0: "center", 1: "bottom"}
    return axes.annotate(
        name,
        point,
        xytext=offset,
        textcoords="offset points",
        ha=sides[0][int(np.sign(right))],
        va=sides[1][int(np.sign(up))],
        **leads,
        **text,
    )


def _within(box: Bbox, room: Bbox) -> bool:
    return room.x0 <= box.x0 and box.x1 <= room.x1 and room.y0 <= box.y0 and box.y1 <= room.y1
