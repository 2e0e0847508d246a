"""The nodes of a cross-section: their shares in its area, and how its corners follow from those of its outline.

A section's mesh is of quadrilaterals, on which shape functions N of order 1 or 2 are polynomials of the reference
coordinates (s, t) in [0, 1]^2. The nodes say where the sides are: those of order 2 may be curved.

The corners of a section are those of its bounding box. If they are no nodes, they are extrapolated: with y'
and z', coordinates over the halves of the box, the corners c_k are such that

    x(y, z) = sum over k of N_k(y', z') c_k,    N_k = (1 + y_k y') (1 + z_k z') / 4,

fits the outline's nodes best, each weighted by its share of the outline's length. A bent circle deviates from that by
v = -nu kappa (y^2 - z^2) / 2, 0.6 mm at a radius of 10 mm and a curvature of 16 1/m, whose size follows from the
bilinear w = -nu kappa y z (rom/native/contact/slices.c adds it); 0.09 mm are left (95 % of sections, worst node).
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from rom.brief import brief
from rom.dataset.grid import SHARE

CORNERS = np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])  # y and z of a section's corners, over half its extents [-]
POINTS, WEIGHTS = np.array([0.5 - 0.15**0.5, 0.5, 0.5 + 0.15**0.5]), np.array([5, 8, 5]) / 18  # Gauss, to degree 5
SIDES = [(0, 1), (1, 3), (2, 3), (0, 2)]  # ends of a quadrilateral's sides, among its corners in tensor order


@brief
@dataclass(frozen=True, kw_only=True)
class PlaneNodes:
    """Nodes of a cross-section.

    Attributes:
        weights: integrals of the shape functions over the section's area, divided by it, shape (nodes,) [-].
        corners: what the corners -y -z, -y z, y -z and y z are of the nodes' positions, and of those of their mirror
            images in z = 0 where half a section is meshed, shape (2, 4, nodes) [-].
        is_half: whether only the half z >= 0 is meshed.
    """

    weights: np.ndarray
    corners: np.ndarray
    is_half: bool


def plane_nodes(nodes: np.ndarray, points: np.ndarray, quads: np.ndarray, box: np.ndarray, is_half: bool) -> PlaneNodes:
    """The nodes of a mesh of quadrilaterals; of order 1 if these are its points, else of order 2.

    Args:
        nodes: y and z, shape (nodes, 2) [m].
        points: of the mesh, shape (points, 2) [m].
        quads: their corners among the points in tensor order, shape (quads, 4).
        box: halves of the whole section's box along y and z, shape (2,) [m].
        is_half: whether only the half z >= 0 is meshed.
    """
    order = 1 if len(nodes) == len(points) else 2
    reference = np.linspace(0.0, 1.0, order + 1)
    places = np.stack(np.meshgrid(reference, reference), axis=-1).reshape(-1, 2)  # s runs fastest
    _, node = cKDTree(nodes).query(np.einsum("pc,qci->qpi", _bilinear(places), points[quads]))
    weights = np.zeros(len(nodes))
    np.add.at(weights, node, _integrals(nodes[node], order))
    images = np.array([[1, 1], [1, -1]])[: 1 + is_half]
    corners = _corners(nodes / box, *_outline(quads, node, nodes, is_half), images)
    return PlaneNodes(weights=weights / weights.sum(), corners=corners, is_half=is_half)


def _bilinear(places: np.ndarray) -> np.ndarray:
    """Bilinear shape functions at reference coordinates, shapes (n, 2) and (n, 4), in tensor order."""
    s, t = places.T
    return np.stack([(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t], axis=1)


def _lagrange(at: np.ndarray, order: int) -> np.ndarray:
    """Shape functions on [0, 1], shape (n, order + 1)."""
    if order == 1:
        return np.stack([1 - at, at], axis=1)
    return np.stack([(1 - at) * (1 - 2 * at), 4 * at * (1 - at), at * (2 * at - 1)], axis=1)


def _lagrange_slopes(at: np.ndarray, order: int) -> np.ndarray:
    """Their derivatives, shape (n, order + 1)."""
    if order == 1:
        return np.tile([-1.0, 1.0], (len(at), 1))
    return np.stack([4 * at - 3, 4 - 8 * at, 4 * at - 1], axis=1)


def _integrals(nodes: np.ndarray, order: int) -> np.ndarray:
    """Integrals of shape functions over quadrilaterals, shapes (quads, nodes, 2) [m] and (quads, nodes) [m^2].

    Exact: shape functions times the Jacobian determinant are of degree 5 at most along s and t.
    """
    along, slopes = _lagrange(POINTS, order), _lagrange_slopes(POINTS, order)
    integrals = np.zeros(nodes.shape[:2])
    for i, j in np.ndindex(len(POINTS), len(POINTS)):  # t, then s
        by_s, by_t = (np.outer(*pair).ravel() @ nodes for pair in ((along[i], slopes[j]), (slopes[i], along[j])))
        area = by_s[:, 0] * by_t[:, 1] - by_s[:, 1] * by_t[:, 0]
        integrals += WEIGHTS[i] * WEIGHTS[j] * area[:, None] * np.outer(along[i], along[j]).ravel()
    return integrals


def _outline(quads: np.ndarray, node: np.ndarray, nodes: np.ndarray, is_half: bool) -> tuple[np.ndarray, np.ndarray]:
    """Nodes on a section's outer border, shape (k,), and their shares of its length, shape (k,) [m].

    A border within is a bore's; a half's cut along z = 0 is none.
    """
    size = math.isqrt(node.shape[1])
    local = np.arange(size**2).reshape(size, size)
    pairs = np.sort(np.stack([quads[:, pair] for pair in SIDES], axis=1).reshape(-1, 2), axis=1)
    _, where, count = np.unique(pairs, axis=0, return_inverse=True, return_counts=True)
    sides = node[:, [local[0], local[:, -1], local[-1], local[:, 0]]].reshape(-1, size)[count[where.ravel()] == 1]
    if is_half:
        sides = sides[np.abs(nodes[sides, 1]).max(axis=1) > SHARE * np.abs(nodes).max()]
    along = coo_matrix((np.ones(len(sides)), (sides[:, 0], sides[:, -1])), shape=(len(nodes),) * 2)
    part = connected_components(along, directed=False)[1]
    ends = sides[:, [0, -1]].ravel()  # a node amid a side is of no part
    sides = sides[part[sides[:, 0]] == part[ends[nodes[ends, 0].argmax()]]]
    shares = np.zeros(len(nodes))
    lengths = np.linalg.norm(nodes[sides[:, -1]] - nodes[sides[:, 0]], axis=1)
    np.add.at(shares, sides, lengths[:, None] * ([1 / 2, 1 / 2] if size == 2 else [1 / 6, 4 / 6, 1 / 6]))
    nodes_of_outline = np.flatnonzero(shares)
    return nodes_of_outline, shares[nodes_of_outline]


def _corners(scaled: np.ndarray, outline: np.ndarray, shares: np.ndarray, images: np.ndarray) -> np.ndarray:
    """Weights that give corners from the outline's nodes and their images, at y' and z', shape (nodes, 2)."""
    weights = np.zeros((2, len(CORNERS), len(scaled)))
    away, nearest = map(np.array, zip(*(cKDTree(scaled * image).query(CORNERS) for image in images), strict=True))
    if away.min(axis=0).max() < SHARE:
        which, corner = away.argmin(axis=0), np.arange(len(CORNERS))
        weights[which, corner, nearest[which, corner]] = 1.0
        return weights
    shape = np.concatenate([np.prod(1 + CORNERS * (scaled[outline] * one)[:, None], axis=2) / 4 for one in images])
    weighted = shape * np.tile(shares, len(images))[:, None]
    fitted = np.linalg.solve(weighted.T @ shape, weighted.T)
    weights[: len(images), :, outline] = fitted.reshape(len(CORNERS), len(images), -1).transpose(1, 0, 2)
    return weights
