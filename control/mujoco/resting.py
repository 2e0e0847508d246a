"""The pose in which a solid rests on a table: a solid whose centre is beside its foot rolls until it is above it.

A solid that does not stand turns about the point of its foot nearest to its centre, until another corner has contact.
With every turn the centre gets lower, so that the solid comes to rest on a face.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from control.mujoco.solids import TOUCHES_TABLE, Solid, centre_of, half_width

LEVEL = np.radians(2.0)  # slope of a table on which a solid must stand to be at rest [rad]


def at_rest(solid: Solid) -> Solid:
    """Return a mesh as it rests on the table: centred above the origin, and grasped at the height of its centre.

    Other shapes stand as they are. The solid stands on a table with a slope up to LEVEL, or no turn lowers its centre.
    """
    if solid.shape != "mesh":
        return solid
    corners, centre = solid.corners, centre_of(solid.corners)
    while (rolled := _rolled(corners, centre)) is not None:
        lower = centre_of(rolled)
        if lower[2] >= centre[2]:
            break
        corners, centre = rolled, lower
    corners, height = corners - [centre[0], centre[1], 0.0], float(centre[2])
    return replace(solid, corners=corners, grasped=height, radius=half_width(corners, height))


def _rolled(corners: np.ndarray, centre: np.ndarray) -> np.ndarray | None:
    """Corners after one turn, shape (n, 3) [m]; None if the solid stands."""
    is_foot = corners[:, 2] < TOUCHES_TABLE
    nearest, inside = _edge_of(corners[is_foot, :2], centre[:2])
    out = (centre[:2] - nearest) * (-1 if inside else 1)
    beyond = float(np.linalg.norm(out))
    if inside and beyond > np.tan(LEVEL) * centre[2]:
        return None
    out = np.append(out / beyond, 0.0)
    relative = corners - [*nearest, 0.0]
    angles = np.arctan2(relative[:, 2], relative @ out)  # at which a corner has contact
    turn = Rotation.from_rotvec(np.cross([0.0, 0.0, 1.0], out) * angles[~is_foot].min())
    turned = turn.apply(relative)
    return np.asarray(turned - [0.0, 0.0, turned[:, 2].min()])


def _edge_of(foot: np.ndarray, centre: np.ndarray) -> tuple[np.ndarray, bool]:
    """Point of the edge of a foot, shape (points, 2), nearest to a centre, shape (2,) [m]; True if it is inside."""
    hull = ConvexHull(foot) if len(foot) > 2 else None
    begins = foot if hull is None else foot[hull.vertices]
    sides = np.roll(begins, -1, axis=0) - begins
    lengths = np.maximum((sides**2).sum(axis=1), 1e-30)
    shares = np.clip(((centre - begins) * sides).sum(axis=1) / lengths, 0, 1)
    points = begins + shares[:, None] * sides
    nearest = points[np.linalg.norm(points - centre, axis=1).argmin()]
    return nearest, hull is not None and bool((hull.equations @ [*centre, 1.0] < 0).all())
