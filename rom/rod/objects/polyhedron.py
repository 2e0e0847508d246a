"""A convex polyhedron's faces, edges and corners, as contact asks for them."""

from typing import Any

import numpy as np
from scipy.spatial import ConvexHull, QhullError

FLAT = 1e-7  # triangles whose normals differ by less are one face [-]
MOST_CORNERS = 1000


def polyhedron(points: np.ndarray) -> dict[str, Any]:
    """The convex hull of points, shape (n, 3) [m]: the fields of a hull in fingerfem_object (segment.h).

    Raises:
        ValueError: the points are in one plane, or have too many corners.
    """
    try:
        hull = ConvexHull(points)
    except (QhullError, ValueError) as error:
        raise ValueError(f"vertices must be at least four that are not in one plane, got {len(points)}") from error
    used = hull.vertices
    if len(used) > MOST_CORNERS:
        raise ValueError(f"vertices must make a hull of at most {MOST_CORNERS} corners, got {len(used)}")
    corners, triangles = points[used], np.searchsorted(used, hull.simplices)
    normals = hull.equations[:, :3]
    one, two, three = corners[triangles].swapaxes(0, 1)
    clockwise = np.einsum("ti,ti->t", np.cross(two - one, three - one), normals) < 0
    triangles[clockwise] = triangles[clockwise][:, ::-1]
    face_of = _faces(hull)
    faces = int(face_of.max()) + 1
    normals = np.array([normals[face_of == face].mean(axis=0) for face in range(faces)])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    heights = (corners @ normals.T).max(axis=0)
    ends, sides = _edges(triangles, face_of)
    along = corners[ends[:, 1]] - corners[ends[:, 0]]
    lengths = np.linalg.norm(along, axis=1)
    along /= lengths[:, None]
    first, second = normals[sides[:, 0]], normals[sides[:, 1]]
    swapped = np.einsum("ei,ei->e", along, np.cross(first, second)) < 0
    sides[swapped] = sides[swapped][:, ::-1]
    return {
        "corners": len(corners),
        "edges": len(ends),
        "faces": faces,
        "triangles": len(triangles),
        "vertices": corners,
        "ends": ends,
        "along": along,
        "lengths": lengths,
        "sides": sides,
        "normals": normals,
        "heights": heights,
        "triangle_corners": triangles,
        "triangle_faces": face_of,
    }


def _faces(hull: ConvexHull) -> np.ndarray:
    """Index of each triangle's face, shape (triangles,): neighbours in one plane are one."""
    faces = np.full(len(hull.simplices), -1)
    for first in range(len(faces)):
        if faces[first] >= 0:
            continue
        faces[first], waiting = faces.max() + 1, [first]
        while waiting:
            one = waiting.pop()
            for other in hull.neighbors[one]:
                flat = np.abs(hull.equations[other, :3] - hull.equations[first, :3]).max() < FLAT
                if faces[other] < 0 and flat:
                    faces[other] = faces[first]
                    waiting.append(other)
    return faces


def _edges(triangles: np.ndarray, face_of: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Edges between different faces: their corners and their faces, shapes (edges, 2)."""
    known: dict[tuple[int, int], int] = {}
    ends, sides = [], []
    for triangle, face in zip(triangles.tolist(), face_of.tolist(), strict=True):
        for one, other in zip(triangle, triangle[1:] + triangle[:1], strict=True):
            pair = (min(one, other), max(one, other))
            before = known.setdefault(pair, face)
            if before != face:
                ends.append(pair)
                sides.append((before, face))
    return np.array(ends), np.array(sides)
