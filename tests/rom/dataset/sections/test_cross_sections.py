"""Cross-sections of a grid of nodes move as the finger does: exactly where that is rigid or a homogeneous stretch."""

from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rom.dataset.sections.cross_sections import CrossSections
from rom.dataset.sections.plane_nodes import plane_nodes

LINES = [np.array([0.0, 3e-3, 1e-2, 1.2e-2]), np.array([-5e-3, -2e-3, 0.0, 2e-3, 5e-3])]  # uneven, y symmetric [m]
CASES = list(product((1, 2), (False, True)))  # order, is_half


def nodes_of(order: int, is_half: bool) -> np.ndarray:
    lines = [*LINES, LINES[1][2:] if is_half else LINES[1]]
    if order == 2:
        lines = [np.sort(np.concatenate([line, (line[1:] + line[:-1]) / 2])) for line in lines]
    return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 3)


def sections_of(nodes: np.ndarray, order: int, is_half: bool) -> CrossSections:
    """Sections of that grid, whose cells' corners are every second node of order 2."""
    y, z = (np.unique(line) for line in nodes[:, 1:].T)
    points = np.stack(np.meshgrid(y[::order], z[::order], indexing="ij"), axis=-1).reshape(-1, 2)
    at = np.arange(len(points)).reshape(len(y[::order]), -1)
    quads = np.stack([at[:-1, :-1], at[1:, :-1], at[:-1, 1:], at[1:, 1:]], axis=-1).reshape(-1, 4)
    plane = nodes[: len(y) * len(z), 1:]
    return CrossSections(nodes, order, plane_nodes(plane, points, quads, np.full(2, 5e-3), is_half))


def turn_of(is_half: bool) -> np.ndarray:
    """A large rotation; about z where the mirror symmetry allows no other."""
    return Rotation.from_rotvec([0.0, 0.0, 1.3] if is_half else [0.7, -1.1, 0.9]).as_matrix()


def curved(nodes: np.ndarray, is_half: bool) -> np.ndarray:
    """A displacement that is neither rigid nor homogeneous; its own mirror image in z = 0 for half a finger [m]."""
    x, y, z = (nodes / 5e-3).T
    across = x * z + y * z if is_half else np.cos(x) * y - z**2 + x
    return 1e-3 * np.column_stack([np.sin(x + y) + z**2, x**2 - y * z**2, across])


@pytest.mark.parametrize(("order", "is_half"), CASES)
def test_sections_are_the_element_boundaries_along_the_axis(order, is_half):
    sections = sections_of(nodes_of(order, is_half), order, is_half)
    assert sections.positions == pytest.approx(LINES[0], abs=0)


@pytest.mark.parametrize(("order", "is_half"), CASES)
def test_a_rigid_motion_is_that_motion_of_every_section(order, is_half):
    nodes, turn = nodes_of(order, is_half), turn_of(is_half)
    shift = np.array([4e-3, -2e-3, 0.0 if is_half else 3e-3])
    sections = sections_of(nodes, order, is_half)
    spin, move = np.array([0.0, 0.0, 0.8]), np.array([1.0, 0.5, 0.0])  # a rate of turning about the origin, and a shift
    change = np.cross(spin, nodes @ turn.T + shift) + move
    found = sections.quantities(nodes @ turn.T + shift - nodes, change[None])
    centres = np.column_stack([LINES[0], np.zeros((len(LINES[0]), 2))])
    places = centres @ turn.T + shift
    assert found["section_place"] == pytest.approx(places, abs=1e-16)
    rotations = Rotation.from_quat(found["section_rotation"], scalar_first=True)
    assert rotations.as_matrix() == pytest.approx(np.broadcast_to(turn, (len(places), 3, 3)), abs=1e-14)
    assert (found["section_rotation"][:, 0] >= 0).all()
    assert np.abs(found["section_corners"]).max() < 1e-16
    assert found["section_place_jacobian"][..., 0] == pytest.approx(np.cross(spin, places) + move, abs=1e-15)
    own = turn.T @ spin / 2  # R^T dtheta / 2
    scalar, vector = found["section_rotation"][:, :1], found["section_rotation"][:, 1:]
    expected = np.column_stack([-vector @ own, scalar * own + np.cross(vector, own)])
    assert found["section_rotation_jacobian"][..., 0] == pytest.approx(expected, abs=1e-13)
    assert np.abs(found["section_corners_jacobian"]).max() < 1e-15


@pytest.mark.parametrize(("order", "is_half"), CASES)
def test_a_stretch_moves_positions_and_corners_and_turns_nothing(order, is_half):
    nodes, stretch = nodes_of(order, is_half), np.array([1.3, 0.9, 1.2])
    found = sections_of(nodes, order, is_half).quantities(nodes * (stretch - 1), np.zeros((0, *nodes.shape)))
    centres = np.column_stack([LINES[0], np.zeros((len(LINES[0]), 2))])
    assert found["section_place"] == pytest.approx(centres * stretch, abs=1e-17)
    assert found["section_rotation"] == pytest.approx(np.tile([1.0, 0, 0, 0], (len(centres), 1)), abs=1e-15)
    corners = np.array([[0.0, -5e-3, -5e-3], [0, -5e-3, 5e-3], [0, 5e-3, -5e-3], [0, 5e-3, 5e-3]]) * (stretch - 1)
    assert found["section_corners"] == pytest.approx(np.broadcast_to(corners, (len(centres), 4, 3)), abs=1e-17)


@pytest.mark.parametrize(("order", "is_half"), CASES)
def test_derivatives_are_differences(order, is_half):
    nodes = nodes_of(order, is_half)
    sections, turn = sections_of(nodes, order, is_half), turn_of(is_half)
    at = nodes @ turn.T - nodes + curved(nodes, is_half)
    changes = np.stack([curved(1.5 * nodes, is_half), nodes @ np.diag([0.2, 0.1, 0.3]) + curved(nodes, is_half)])
    found, h = sections.quantities(at, changes), 1e-5
    none = np.zeros((0, *nodes.shape))
    for k, change in enumerate(changes):
        before, after = (sections.quantities(at + step * change, none) for step in (-h, h))
        for name in ("section_place", "section_rotation", "section_corners"):
            slope = (after[name] - before[name]) / (2 * h)
            assert found[f"{name}_jacobian"][..., k] == pytest.approx(slope, abs=1e-8 * max(np.abs(slope).max(), 1e-3))


@pytest.mark.parametrize("order", [1, 2])
def test_half_a_finger_has_the_sections_of_the_whole_one(order):
    answers = []
    for is_half in (True, False):
        nodes = nodes_of(order, is_half)
        at = nodes @ turn_of(True).T - nodes + curved(nodes, True)
        answers.append(sections_of(nodes, order, is_half).quantities(at, curved(1.5 * nodes, True)[None]))
    half, whole = answers
    assert half.keys() == whole.keys()
    for name, values in whole.items():
        assert half[name] == pytest.approx(values, abs=1e-14), name
