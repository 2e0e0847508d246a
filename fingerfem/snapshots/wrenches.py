"""Wrenches of objects on plates, in the plate's frame, drawn for training and for held-out states.

A rigid object touches a plate at the corner that lies deepest in it, or along an edge, or on a face: where the plate's
own surface is normal to the object's, or a corner of it may be. So every wrench is one force at one point of the
plate's surface, along the inward normal there or turned from it by friction. A segment that follows passes forces on
that act elsewhere, as far as it reaches. For elements of longer fingers, half of the wrenches have a moment of any
direction beside the force: the larger the one, the smaller the other.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from fingerfem.scene.scene import Scene
from rom.dataset.sections import section
from rom.dataset.sections.section_outline import SectionOutline

EACH, MOMENT = 9, 3  # numbers that one wrench is drawn by; that its moment is drawn by besides
BEHIND = 0.2  # most of a normal's component along the plate's axis: farther behind, the rubber touches first [-]
CORNERS, EDGES = 0.6, 0.85  # share of forces at corners; at corners or on edges; the others act within faces [-]
WITH_MOMENT = 0.5  # share of wrenches that have a moment of their own, in a scene that has any
AROUND = 64  # sides of the polygon that stands for a round outline
SPREAD = 0.6  # exponent of a uniform share that makes large forces frequent: errors are largest at the ends [-]


def draws(scene: Scene) -> int:
    """Numbers in [0, 1) that the wrenches on all plates are drawn by."""
    each = EACH + (MOMENT if scene.load is not None and scene.load.moment else 0)
    return each * len(scene.geometry.segments)


def on_plates(scene: Scene, drawn: np.ndarray) -> np.ndarray:
    """Wrenches on the plates, shape (n, 6 plates) [N, N m], by numbers in [0, 1), shape (n, draws)."""
    plates = np.split(drawn, len(scene.geometry.segments), axis=1)
    outline, sizes = section.outline(scene.model_dump(mode="json")), scene.geometry.sizes
    own = [
        _on_plate(scene, half, outline.scaled(float(size)), part)
        for half, size, part in zip(scene.geometry.half_lengths, sizes, plates, strict=True)
    ]
    return np.concatenate(own, axis=1)


def _on_plate(scene: Scene, half: np.ndarray, outline: SectionOutline, drawn: np.ndarray) -> np.ndarray:
    load = scene.load
    assert load is not None, "of a scene with a load"
    normal = _directions(drawn[:, 0], drawn[:, 1])
    points = _within(outline, normal, half, _points(normal, half, drawn[:, 2:5]))
    if load.reach:
        points = _ahead(load.reach, drawn[:, 2:5])
    forces = load.force * drawn[:, 5:6] ** SPREAD * _turned(normal, load.friction_angle, drawn[:, 6:8])
    if not load.moment:
        return np.concatenate([forces, np.cross(points, forces)], axis=1)
    share = np.where(drawn[:, 8:9] < WITH_MOMENT, drawn[:, 9:10], 0.0)
    forces *= 1 - share
    along = 2 * drawn[:, 10] - 1
    across, angle = np.sqrt(1 - along**2), 2 * np.pi * drawn[:, 11]
    moments = load.moment * share * np.column_stack([along, across * np.cos(angle), across * np.sin(angle)])
    return np.concatenate([forces, np.cross(points, forces) + moments], axis=1)


def _directions(height: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Unit vectors in a plate's frame, evenly over the sphere but for what lies behind the plate, shape (n, 3)."""
    along = -1 + (1 + BEHIND) * height
    across = np.sqrt(1 - along**2)
    return np.column_stack([along, across * np.cos(2 * np.pi * angle), across * np.sin(2 * np.pi * angle)])


def _points(normal: np.ndarray, half: np.ndarray, drawn: np.ndarray) -> np.ndarray:
    """Points where a plate is touched along normals, shape (n, 3) [m]: its corner, or a point on an edge or a face."""
    points = -np.sign(normal) * half
    kind, elsewhere = drawn[:, 0], half * (2 * drawn[:, [1, 2]] - 1)[:, [0, 1, 0]]
    rank = np.argsort(np.argsort(np.abs(normal), axis=1), axis=1)  # 0 along the edge that the object is closest to
    free = (kind[:, None] >= CORNERS) & (rank == 0) | (kind[:, None] >= EDGES) & (rank == 1)
    return np.where(free, elsewhere, points)


def _within(outline: SectionOutline, normal: np.ndarray, half: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Points of a plate's box, moved to the plate, shape (n, 3) [m].

    A point on an edge along x moves to where the outline has the normal. Others move towards the axis, so that the
    box's border becomes the outline.

    Args:
        outline: of the plate.
        normal: shape (n, 3) [-].
        half: lengths of the box, shape (3,) [m].
        points: shape (n, 3) [m].
    """
    across = points[:, 1:]
    polygon = outline.points(AROUND) if outline.radius else outline.vertices
    sides = np.roll(polygon, -1, axis=0) - polygon
    outward = np.column_stack([sides[:, 1], -sides[:, 0]])
    reach = (across @ (outward / np.sum(outward * polygon, axis=1)[:, None]).T).max(axis=1)  # 1 on the polygon
    inner = np.abs(across / half[1:]).max(axis=1) / np.where(reach > 0, reach, 1.0)
    touched = outline.support(-normal[:, 1:])
    is_edge = (np.abs(across) == half[1:]).all(axis=1)
    return np.column_stack([points[:, 0], np.where(is_edge[:, None], touched, across * inner[:, None])])


def _ahead(reach: float, drawn: np.ndarray) -> np.ndarray:
    """Points of the half ball before a plate, where a segment that follows may be, shape (n, 3) [m]."""
    along, angle, share = drawn.T
    across = np.sqrt(1 - along**2)
    direction = np.column_stack([along, across * np.cos(2 * np.pi * angle), across * np.sin(2 * np.pi * angle)])
    return reach * share[:, None] ** (1 / 3) * direction


def _turned(normal: np.ndarray, most: float, drawn: np.ndarray) -> np.ndarray:
    """Unit vectors within an angle of normals [rad], shape (n, 3)."""
    if not most:
        return normal
    across = np.cross(normal, np.roll(normal, 1, axis=1) + np.array([1.0, 0.5, 0.25]))
    across /= np.linalg.norm(across, axis=1)[:, None]
    around = Rotation.from_rotvec(2 * np.pi * drawn[:, :1] * normal).apply(across)
    return Rotation.from_rotvec(most * np.sqrt(drawn[:, 1:]) * around).apply(normal)
