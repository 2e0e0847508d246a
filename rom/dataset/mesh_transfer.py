"""States of one finger on two meshes: which sets are of it, and what brings a field from one mesh to the other."""

import re
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix
from scipy.spatial import Delaunay, cKDTree

from rom.dataset.description import NOT_OF_THE_FINGER, difference
from rom.dataset.grid import levels
from rom.dataset.snapshot_set import SnapshotError, SnapshotSet

OWN = (*NOT_OF_THE_FINGER, "mesh")  # keys of a scene that may differ
WHOLE = 1.5  # extents of the fine mesh over the coarse one's: between those of circles of few cells, and of a half [-]
FLAT = 1e-6  # area of a triangle over the largest one's, below which it holds no point [-]


def check_finger(snapshots: SnapshotSet, scene: dict[str, Any], of: str) -> None:
    """Refuse a set of another finger than a scene's; of what it is the scene is said in words.

    Raises:
        SnapshotError: they differ by more than mesh and sampling.
    """
    own = snapshots.description.scene
    other = difference(scene, own, OWN)
    if other:
        key = re.match(r"\w+", other)
        raise SnapshotError(f"{snapshots.path}: must have the {key[0] if key else 'scene'} of {of}: {other}")


def interpolation(coarse: np.ndarray, fine: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """Interpolation of fields from the nodes of one mesh to those of another; both are swept along the axis.

    It is linear along the axis and on triangles of a section's nodes, of whatever size the section is.

    Args:
        coarse: places of the nodes from which, shape (nodes, 3) [m].
        fine: of those to which.

    Raises:
        SnapshotError: the coarse mesh is not swept, or is of a half of the other finger.
    """
    if (np.ptp(fine, axis=0) > WHOLE * np.ptp(coarse, axis=0)).any():
        raise SnapshotError("both meshes must be of the same part of the finger, got a half and a whole one")
    lines, layer = levels(coarse[:, 0])
    each, count = np.bincount(layer), len(coarse) // len(lines)
    if (each != count).any():
        raise SnapshotError(f"nodes of the coarse mesh must be as many on all planes, got {each.min()} to {each.max()}")
    sizes = np.zeros(len(lines))
    np.maximum.at(sizes, layer, np.abs(coarse[:, 1:]).max(axis=1))
    y, z = (coarse[:, 1:] / sizes[layer][:, None]).T
    order = np.lexsort((levels(z)[1], levels(y)[1], layer)).reshape(len(lines), count)
    scaled = np.column_stack([fine[:, 1], fine[:, 2]]) / np.interp(fine[:, 0], lines, sizes)[:, None]
    node, across = _on_triangles(np.column_stack([y, z])[order[0]], scaled)
    first = np.clip(np.searchsorted(lines, fine[:, 0]) - 1, 0, len(lines) - 2)
    share = np.clip((fine[:, 0] - lines[first]) / np.diff(lines)[first], 0.0, 1.0)[:, None]
    columns = np.hstack([order[first[:, None], node], order[first[:, None] + 1, node]])
    rows = np.repeat(np.arange(len(fine)), columns.shape[1])
    weights = np.hstack([(1 - share) * across, share * across])
    matrix = csr_matrix((weights.ravel(), (rows, columns.ravel())), shape=(len(fine), len(coarse)))

    def bring(fields: np.ndarray) -> np.ndarray:
        return np.asarray(matrix @ fields.reshape(len(coarse), -1)).reshape(3 * len(fine), -1)

    return bring


def _on_triangles(nodes: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes whose triangles hold points, or are the nearest to them, and their weights, shapes (points, 3) [-]."""
    mesh = Delaunay(nodes)
    corners = nodes[mesh.simplices]
    areas = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1]))
    whole = np.flatnonzero(areas > FLAT * areas.max())  # nodes in line by rounding have flat triangles between them
    holding = mesh.find_simplex(points)
    other = ~np.isin(holding, whole)  # or none at all
    holding[other] = whole[cKDTree(corners[whole].mean(axis=1)).query(points[other])[1]]
    to_weights, origin = mesh.transform[holding, :2], mesh.transform[holding, 2]
    two = np.einsum("nij,nj->ni", to_weights, points - origin)
    return mesh.simplices[holding], np.column_stack([two, 1 - two.sum(axis=1)])
