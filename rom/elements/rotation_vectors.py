"""Rodrigues vectors of rotations, g = tan(angle / 2) axis, and their changes with small turns.

R(g) = 1 + 2 / (1 + g.g) ([g]x + [g]x [g]x). With a turn t on the left, R -> exp([t]x) R, the vector changes by
dg = (t + t x g + (g.t) g) / 2, and t = 2 (dg + g x dg) / (1 + g.g). (Bauchau, Trainelli, Nonlinear Dynamics 32, 2003,
doi:10.1023/A:1024265401576.) An element turns by far less than 180 degrees, where g is infinite.
"""

import numpy as np


def cross_matrices(vectors: np.ndarray) -> np.ndarray:
    """[v]x of vectors, shapes (..., 3), (..., 3, 3), so that [v]x a = v x a."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    zero = np.zeros_like(x)
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def matrices(vectors: np.ndarray) -> np.ndarray:
    """Rotation matrices of Rodrigues vectors, shapes (..., 3), (..., 3, 3) [-]."""
    turned = cross_matrices(vectors)
    scale = 2.0 / (1.0 + np.sum(vectors * vectors, axis=-1))[..., None, None]
    return np.asarray(np.eye(3) + scale * (turned + turned @ turned))


def vectors(rotations: np.ndarray) -> np.ndarray:
    """Rodrigues vectors of rotation matrices, shapes (..., 3, 3), (..., 3) [-]; infinite at half a turn."""
    twice = np.stack([rotations[..., i, j] - rotations[..., j, i] for i, j in ((2, 1), (0, 2), (1, 0))], axis=-1)
    return np.asarray(twice / (1.0 + np.trace(rotations, axis1=-2, axis2=-1))[..., None])


def changes(vectors: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Changes of Rodrigues vectors, shape (n, 3), with turns on the left, shape (n, 3, k) [rad]; shape (n, 3, k)."""
    along = np.einsum("ni,nik->nk", vectors, turns)
    return np.asarray(turns + np.cross(turns, vectors[:, :, None], axis=1) + vectors[:, :, None] * along[:, None]) / 2


def turns(vectors: np.ndarray, changes: np.ndarray) -> np.ndarray:
    """The turns on the left, shape (n, 3, k) [rad], that change Rodrigues vectors, shape (n, 3), by (n, 3, k)."""
    scale = 2.0 / (1.0 + np.sum(vectors * vectors, axis=1))[:, None, None]
    return np.asarray(scale * (changes + np.cross(vectors[:, :, None], changes, axis=1)))


def angles(rotations: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Angles between frames, shapes (n, 3, 3), (n,) [rad]: |R - S| = 2 sqrt(2) sin(angle / 2)."""
    apart = np.linalg.norm(rotations - others, axis=(-2, -1)) / np.sqrt(8.0)
    return np.asarray(2.0 * np.arcsin(np.clip(apart, 0.0, 1.0)))
