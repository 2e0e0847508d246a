"""States of one finger on two meshes: which sets are of it, and what brings a field from one mesh to the other."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from rom.dataset.description import NOT_OF_THE_FINGER, difference
from rom.dataset.grid import SHARE, levels
from rom.dataset.snapshot_set import SnapshotError, SnapshotSet

OWN = (*NOT_OF_THE_FINGER, "mesh")  # keys of a scene that may differ


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
    """Interpolation of fields from the nodes of one mesh to those of another; both lie on grid lines.

    Args:
        coarse: places of the nodes from which, shape (nodes, 3) [m].
        fine: of those to which.

    Raises:
        SnapshotError: the coarse nodes do not fill a grid, or are of a half of the other finger.
    """
    if (np.ptp(fine, axis=0) > (1 + SHARE) * np.ptp(coarse, axis=0)).any():
        raise SnapshotError("both meshes must be of the same part of the finger, got a half and a whole one")
    lines, where = zip(*(levels(along) for along in coarse.T), strict=True)
    shape = tuple(len(line) for line in lines)
    if np.prod(shape) != len(coarse):
        raise SnapshotError(f"nodes of the coarse mesh must fill a grid of {shape}, got {len(coarse)}")
    targets = np.column_stack([np.clip(fine[:, a], line[0], line[-1]) for a, line in enumerate(lines)])

    def bring(columns: np.ndarray) -> np.ndarray:
        grid = np.zeros((*shape, 3 * columns.shape[1]))
        grid[where] = columns.reshape(len(coarse), -1)
        return np.asarray(RegularGridInterpolator(lines, grid)(targets).reshape(3 * len(fine), -1))

    return bring
