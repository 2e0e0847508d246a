"""The section of a finger at the clamp, by the tables of its scene as plain data.

A square is `geometry.side`. Any other section has a table `section`: `shape`, and its sizes, or what the full-order
model has measured of a file.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from rom.dataset.sections.section_outline import SectionOutline

SQUARE, RECTANGLE, CIRCLE, RING, FILE = "square", "rectangle", "circle", "ring", "file"
# Sizes of every shape in a table, the first the one that others are compared to.
SIZES = {SQUARE: ("side",), RECTANGLE: ("height", "width"), CIRCLE: ("diameter",), RING: ("diameter", "bore"), FILE: ()}


def section_of(scene: Mapping[str, Any]) -> dict[str, Any]:
    """Table of a scene's section: `shape` and sizes [m]."""
    return scene.get("section") or {"shape": SQUARE, "side": scene["geometry"]["side"]}


def outline(scene: Mapping[str, Any]) -> SectionOutline:
    """The convex hull of its border.

    Raises:
        ModelError: it does not enclose the axis.
    """
    table = section_of(scene)
    if table["shape"] == FILE:
        return SectionOutline.hull(table["measures"]["hull"])
    if table["shape"] in (CIRCLE, RING):
        return SectionOutline.circle(table["diameter"] / 2)
    return SectionOutline.rectangle(*(table[name] / 2 for name in (SIZES[table["shape"]] * 2)[:2]))


def extent(scene: Mapping[str, Any]) -> float:
    """The largest side of its box about the axis [m], which lengths along the finger are measured by."""
    return float(2 * outline(scene).box.max())


def area(scene: Mapping[str, Any]) -> float:
    """Area of the section without its bore [m^2]."""
    table = section_of(scene)
    if table["shape"] == FILE:
        return float(table["measures"]["area"])
    return outline(scene).area - math.pi / 4 * float(table.get("bore", 0.0)) ** 2


def mean_squares(scene: Mapping[str, Any]) -> np.ndarray:
    """Means of y^2 and z^2 over the section, shape (2,) [m^2]: its second moments over its area."""
    table = section_of(scene)
    if table["shape"] == FILE:
        return np.array(table["measures"]["mean_squares"])
    if table["shape"] in (CIRCLE, RING):
        return np.full(2, (table["diameter"] ** 2 + table.get("bore", 0.0) ** 2) / 16)
    return np.asarray(outline(scene).box ** 2 / 3)


def channel_width(scene: Mapping[str, Any]) -> float:
    """Width of a channel [m]; 0 for a section from a file, which has its channels drawn."""
    table, given = section_of(scene), scene["geometry"].get("channel")
    if given is not None or table["shape"] == FILE:
        return float(given or 0.0)
    widths = [table[name] / 5 for name in SIZES[table["shape"]] if name != "bore"]
    return min([*widths, *([(table["diameter"] - table["bore"]) / 4] if "bore" in table else [])])


def top(scene: Mapping[str, Any]) -> float:
    """The largest y [m], on which the plane y = top + d faces the finger; half the side of a square."""
    return float(outline(scene).support([[1.0, 0.0]])[0, 0])
