"""What FElupe's boundary regions make of a gradient; imported in FElupe's own process alone.

`felupe.RegionTriQuadraticHexahedronBoundary` turns every cell so that its facet lies below. In three of the six turned
cells of FElupe 11.3.0 the nodes in the middle of two opposite facets beside it are interchanged, so that gradients of
what is not linear are wrong there. (Values and areas are right, and so is all of 8 nodes.)
"""

from __future__ import annotations

from typing import Any

import felupe
import numpy as np

FACES = [(axis, side) for axis in range(3) for side in (-1, 1)]


def gradient_errors() -> tuple[np.ndarray, list[dict[str, Any]]]:
    """Largest error of the gradients of x^2, y^2 and z^2 [-] on each facet of one cell, by FElupe's own regions.

    Their elements reproduce these functions: the error should be round-off.
    """
    points = felupe.TriQuadraticHexahedron().points
    mesh = felupe.Mesh(points, np.arange(len(points))[None], "hexahedron27")
    rows = []
    for axis, side in FACES:
        region = felupe.RegionTriQuadraticHexahedronBoundary(mesh, mask=points[:, axis] == side)
        places = felupe.Field(region, dim=3, values=points).interpolate()
        gradient = felupe.Field(region, dim=3, values=points**2).grad()
        exact = 2 * np.eye(3)[:, :, None, None] * places[:, None]
        rows.append({"axis": "xyz"[axis], "side": side, "error": float(np.abs(gradient - exact).max())})
    return np.zeros((0, len(points), 3)), rows
