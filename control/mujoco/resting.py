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
BALANCED = 1e-9  # distance of the centre from an edge below which it is above the edge [m]


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
    nearest, out, within = _edge_of(corners[is_foot, :2], centre[:2])
    if within > np.tan(LEVEL) * centre[2]:
        return None
    out = np.append(out, 0.0)
    relative = corners - [*nearest, 0.0]
    angles = np.arctan2(relative[:, 2], relative @ out)  # at which a corner has contact
    turn = Rotation.from_rotvec(np.cross([0.0, 0.0, 1.0], out) * angles[~is_foot].min())
    turned = turn.apply(relative)
    return np.asarray(turned - [0.0, 0.0, turned[:, 2].min()])


def _edge_of(foot: np.ndarray, centre: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """The edge of a foot, shape (points, 2), nearest to a centre, shape (2,) [m].

    Returns:
        the edge's nearest point [m]; the unit vector across it, out of the foot; and how far the centre is within [m].
    """
    hull = ConvexHull(foot) if len(foot) > 2 else None
    begins = foot[hull.vertices] if hull else foot  # counterclockwise
    sides = np.roll(begins, -1, axis=0) - begins
    lengths = np.maximum((sides**2).sum(axis=1), 1e-30)
    shares = np.clip(((centre - begins) * sides).sum(axis=1) / lengths, 0, 1)
    points = begins + shares[:, None] * sides
    k = np.linalg.norm(points - centre, axis=1).argmin()
    is_inside = hull is not None and bool((hull.equations @ [*centre, 1.0] < 0).all())
    away = centre - points[k]
    within = float(np.linalg.norm(away)) * (1 if is_inside else -1)
    if abs(within) < BALANCED:  # above the edge, or above the one corner of the foot
        away = np.array([sides[k, 1], -sides[k, 0]]) if sides[k].any() else np.array([1.0, 0.0])
        return points[k], away / np.linalg.norm(away), within
    return points[k], -away / within, within
