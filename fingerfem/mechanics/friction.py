"""Coulomb friction at points of a surface, by a penalty and its return mapping.

A point that touches has a tangential spring of stiffness k [N/m] between its place x and its anchor a, which moves with
the obstacle. With the normal n, the tangential projection P = 1 - n n^T, the stretch s = P (x - a) and the most that it
may bear, b = mu N, its potential is

    k |s|^2 / 2  where k |s| <= b (it sticks),    b |s| - b^2 / (2 k)  elsewhere (it slides),

whose gradient is a force of at most b. For given bounds it is convex and its tangent symmetric: the problem of Tresca.
Coulomb's is a fixed point of it, where b is mu times the contact's own normal force (Nečas, Jarušek, Haslinger, Boll.
Unione Mat. Ital. 17-B, 1980). When an increment ends, the anchors of points that slid follow, so that the spring is
left with b: the return mapping (Wriggers, Computational Contact Mechanics, 2006, section 5.2).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Tangential(NamedTuple):
    """What tangential springs of m points do.

    Attributes:
        energy: of each, shape (m,) [J].
        forces: gradients of the energies by the places, shape (m, 3) [N].
        stiffness: their derivatives, shape (m, 3, 3) [N/m].
        slides: whether it slides, shape (m,).
        slipped: how far it has slid since its anchor was set, shape (m, 3) [m].
    """

    energy: np.ndarray
    forces: np.ndarray
    stiffness: np.ndarray
    slides: np.ndarray
    slipped: np.ndarray


def springs(
    places: np.ndarray, anchors: np.ndarray, normals: np.ndarray, k: np.ndarray, bounds: np.ndarray
) -> Tangential:
    """The springs at places and from anchors, shapes (m, 3) [m].

    Args:
        places: of the points.
        anchors: of their springs.
        normals: of the obstacle where the points are, shape (m, 3) [-].
        k: stiffnesses, shape (m,) [N/m].
        bounds: the largest forces, shape (m,) [N].
    """
    across = np.eye(3) - normals[:, :, None] * normals[:, None]
    s = np.einsum("mij,mj->mi", across, places - anchors)
    length = np.linalg.norm(s, axis=1)
    slides = k * length > bounds
    size = np.where(slides, length, 1.0)
    along = np.where(slides, bounds / size, k)  # force over stretch [N/m]
    unit = s / size[:, None]
    turning = np.where(slides, bounds / size, 0.0)[:, None, None] * unit[:, :, None] * unit[:, None]
    return Tangential(
        energy=np.where(slides, bounds * length - bounds**2 / (2 * k), k * length**2 / 2),
        forces=along[:, None] * s,
        stiffness=along[:, None, None] * across - turning,
        slides=slides,
        slipped=np.where(slides[:, None], s - (bounds / k)[:, None] * unit, 0.0),
    )
