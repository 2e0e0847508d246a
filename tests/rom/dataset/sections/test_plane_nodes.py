"""Nodes of any section's mesh: weights integrate what shape functions represent, corners follow from the outline."""

import numpy as np
import pytest

from rom.dataset.sections.plane_nodes import CORNERS, PlaneNodes, plane_nodes

BOX = np.array([8e-3, 5e-3])  # [m]


def warped(s: np.ndarray, t: np.ndarray) -> np.ndarray:
    """A section without right angles, its own mirror image in z = 0, by coordinates in [-1, 1]; shape (..., 2) [m]."""
    return np.stack([BOX[0] * s * (1 - 0.2 * t**2), BOX[1] * t * (1 - 0.3 * s + 0.1 * s**2) / 1.4], axis=-1)


def mesh(order: int, is_half: bool = False, hollow: bool = False) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes, points and quadrilaterals of its mesh; without the middle cells if it is hollow."""
    s, t = np.linspace(-1, 1, 7), np.linspace(0 if is_half else -1, 1, 4 if is_half else 7)
    points = warped(*np.meshgrid(s, t, indexing="ij")).reshape(-1, 2)
    at = np.arange(len(points)).reshape(len(s), len(t))
    quads = np.stack([at[:-1, :-1], at[1:, :-1], at[:-1, 1:], at[1:, 1:]], axis=-1).reshape(-1, 4)
    if hollow:
        middle = np.abs(points[quads].mean(axis=1)).max(axis=1) < 1.5e-3
        quads = quads[~middle]
    used, numbers = np.unique(quads, return_inverse=True)
    points, quads = points[used], numbers.reshape(-1, 4)
    if order == 1:
        return points, points, quads
    a, b, c, d = points[quads].transpose(1, 0, 2)
    more = np.concatenate([(a + b) / 2, (b + d) / 2, (d + c) / 2, (c + a) / 2, (a + b + c + d) / 4])
    return np.unique(np.concatenate([points, more]).round(12), axis=0), points, quads


def nodes_of(order: int, **which: bool) -> tuple[np.ndarray, PlaneNodes, np.ndarray]:
    """Nodes, what is known of them, and the corners of the quadrilaterals around these."""
    nodes, points, quads = mesh(order, **which)
    return nodes, plane_nodes(nodes, points, quads, BOX, which.get("is_half", False)), points[quads[:, [0, 1, 3, 2]]]


@pytest.mark.parametrize("hollow", [False, True])
@pytest.mark.parametrize("order", [1, 2])
def test_means_are_those_of_the_polygons_between_the_nodes(order, hollow):
    nodes, found, corners = nodes_of(order, hollow=hollow)
    here, after = corners, np.roll(corners, -1, axis=1)
    cross = here[..., 0] * after[..., 1] - here[..., 1] * after[..., 0]
    area = cross.sum() / 2
    assert found.weights.sum() == pytest.approx(1, abs=1e-15)
    centroid = (cross[..., None] * (here + after)).sum(axis=(0, 1)) / 6 / area
    assert found.weights @ nodes == pytest.approx(centroid, abs=1e-12)  # to which the nodes are rounded
    if order == 2:  # a square is interpolated by itself on quadrilaterals with straight sides
        (y, _), (yn, _) = np.moveaxis(here, -1, 0), np.moveaxis(after, -1, 0)
        second = (cross * (y**2 + y * yn + yn**2)).sum() / 12 / area
        assert found.weights @ nodes[:, 0] ** 2 == pytest.approx(second, rel=1e-9)


def bulging(half: float) -> tuple[np.ndarray, PlaneNodes]:
    """A square, three sides of which are parabolas, in a box of half sides: its nodes, and what is known of them."""
    s, t = np.meshgrid([-1.0, 0.0, 1.0], [-1.0, 0.0, 1.0])
    square = np.column_stack([s.ravel(), t.ravel()])
    nodes = square.copy()
    nodes[[1, 5, 7]] *= 1.3
    nodes[4] += (nodes[[1, 5, 7]] - square[[1, 5, 7]]).sum(axis=0) / 2
    corners = square[[0, 2, 6, 8]]
    return nodes, plane_nodes(nodes, corners, np.array([[0, 1, 2, 3]]), np.full(2, half), False)


def test_sides_of_order_two_are_curved_where_their_nodes_are():
    nodes, found = bulging(1.0)
    segment = 2 / 3 * 2 * 0.3  # of a parabola, with its centroid at 2/5 of its height
    assert found.weights @ nodes[:, 0] == pytest.approx(segment * 1.12 / (4 + 3 * segment), rel=1e-12)
    assert found.weights @ nodes[:, 1] == pytest.approx(0.0, abs=1e-15)


def test_an_outline_whose_outermost_node_is_amid_a_side_has_corners():
    nodes, found = bulging(1.3)
    assert found.corners[0] @ nodes == pytest.approx(1.3 * CORNERS, abs=1e-12)


@pytest.mark.parametrize("hollow", [False, True])
@pytest.mark.parametrize("order", [1, 2])
def test_corners_are_extrapolated_from_a_bilinear_motion_of_the_outline_alone(order, hollow):
    nodes, found, _ = nodes_of(order, hollow=hollow)
    basis = lambda at: np.column_stack([np.ones(len(at)), at, at.prod(axis=1)])  # noqa: E731
    motion = np.random.default_rng(1).normal(size=(4, 3))
    assert found.corners[0] @ basis(nodes / BOX) @ motion == pytest.approx(basis(CORNERS) @ motion, abs=1e-12)
    assert not found.corners[1].any()
    border = np.abs(found.corners[0]).max(axis=0) > 0
    inside = np.abs(nodes[~border] / BOX).max(axis=1)
    assert border.sum() == (6 * 4) * order and inside.max() < 0.9


@pytest.mark.parametrize("order", [1, 2])
def test_half_a_section_has_the_corners_of_the_whole_one(order):
    nodes, whole, _ = nodes_of(order)
    half_nodes, half, _ = nodes_of(order, is_half=True)
    motion = lambda at: np.column_stack([at[:, 0] ** 3, at[:, 1] ** 2, at[:, 0] * at[:, 1]])  # noqa: E731
    images = half.corners[0] @ motion(half_nodes) + half.corners[1] @ motion(half_nodes) * [1, 1, -1]
    assert images == pytest.approx(whole.corners[0] @ motion(nodes), abs=1e-13)


def test_nodes_at_the_corners_are_these():
    points = BOX * [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]]
    found = plane_nodes(points, points, np.array([[0, 2, 1, 3]]), BOX, False)
    assert found.corners[0] == pytest.approx(np.eye(4), abs=0)
