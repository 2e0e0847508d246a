"""The motion of a finger's cross-sections, from the displacement of its nodes.

A section is a grid plane of the mesh across the axis. Its position is the mean c of its nodes' positions x, and its
rotation R is that of the polar decomposition M = R U of

    M = sum of w (x - c) (X - X_c)^T     [m^2],

where the weights w [-], of sum 1, are the integrals of the nodes' shape functions over the plane. X - X_c lies in the
plane, so M has rank 2; R is unique all the same, and `rigid_motion.turns` differentiates it.

Of a section with voids it is the rubber around them, everywhere along the finger: also where a void is filled.

Of half a finger, z >= 0, the sections are whole: of the mirror image, c and M have the same entries with an even number
of z, and the others cancel.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rom.dataset import rigid_motion
from rom.dataset.grid import SHARE, levels


def line_weights(line: np.ndarray, order: int) -> np.ndarray:
    """Integrals of the shape functions of nodes on a line, divided by its length, shape (nodes,) [-].

    These are the trapezoidal rule for order 1 and Simpson's for order 2.

    Args:
        line: coordinates of the nodes, ascending, those between the ends of cells included, shape (nodes,) [m].
        order: Lagrange order of the cells.
    """
    own = np.array([1, 1]) / 2 if order == 1 else np.array([1, 4, 1]) / 6
    lengths = np.diff(line[::order])
    found = np.zeros(len(line))
    for k, share in enumerate(own):
        found[k : k + order * len(lengths) : order] += share * lengths
    return found / lengths.sum()


def _weights(y: np.ndarray, z: np.ndarray, order: int, voids: Sequence[np.ndarray]) -> np.ndarray:
    """Integrals of the shape functions over a section without its voids, over their sum, shape (ys, zs) [-].

    They vanish within a void, where it has no nodes.
    """
    whole = np.outer(line_weights(y, order), line_weights(z, order)) * np.ptp(y) * np.ptp(z)
    found, near = whole.copy(), SHARE * float(np.ptp(y))
    for ends in voids:
        at_y, at_z = (
            np.flatnonzero((low - near < line) & (line < high + near))
            for line, low, high in zip((y, z), *ends, strict=True)
        )
        own = np.outer(line_weights(y[at_y], order), line_weights(z[at_z], order))
        found[np.ix_(at_y, at_z)] -= own * np.ptp(y[at_y]) * np.ptp(z[at_z])
    found[found < SHARE * whole] = 0.0
    return np.asarray(found / found.sum())


class CrossSections:
    """The cross-sections of a finger: element boundaries along the axis, so no mid-planes of order 2.

    Args:
        nodes: of the finger at rest, sorted by x, then y, then z, shape (nodes, 3) [m].
        order: Lagrange order of the mesh.
        is_half: whether only the half z >= 0 is modelled.
        voids: rectangles along grid lines that are left out, each [[least y, least z], [largest y, largest z]] [m].

    Attributes:
        positions: along the axis at rest, shape (sections,) [m].

    Example:
        >>> nodes = np.array([[x, y, z] for x in (0, 0.01) for y in (-0.005, 0.005) for z in (-0.005, 0.005)])
        >>> sections = CrossSections(nodes, order=1, is_half=False)
        >>> sections.quantities(np.zeros((8, 3)), np.zeros((0, 8, 3)))["section_place"][:, 0]
        array([0.  , 0.01])
    """

    def __init__(self, nodes: np.ndarray, order: int, is_half: bool, voids: Sequence[np.ndarray] = ()):
        layers, at_x = levels(nodes[:, 0])
        (y, at_y), (z, at_z) = levels(nodes[:, 1]), levels(nodes[:, 2])
        weights = _weights(y, z, order, voids)
        self._kept = weights[at_y, at_z] > 0
        self.positions = layers[::order]
        plane = nodes[self._kept & (at_x == 0)]
        self._shape, self._order, self._is_half = (len(layers), len(plane), 3), order, is_half
        self._weights = weights[at_y, at_z][self._kept & (at_x == 0)]
        across = self._on_sections(nodes) * [0, 1, 1]
        middle = self._mean(across)
        self._arms = across - middle[:, None]
        self._weighted_arms = self._weights[:, None] * self._arms
        self._centres = self.positions[:, None] * [1, 0, 0] + middle
        self._inertia = self._moment(self._arms)
        first, last = len(z) - 1 if is_half else 0, len(z) - 1
        self._corners = np.array([first, last, len(plane) - 1 - last + first, len(plane) - 1])
        self._sides = np.ones((4, 3))
        if is_half:
            self._sides[[0, 2], 2] = -1  # mirror images of the corners that follow them

    def _on_sections(self, fields: np.ndarray) -> np.ndarray:
        """Vectors at all nodes by section, shapes (..., nodes, 3) and (..., sections, nodes of one, 3)."""
        own = fields[..., self._kept, :]
        return own.reshape(*fields.shape[:-2], *self._shape)[..., :: self._order, :, :]

    def _mean(self, fields: np.ndarray) -> np.ndarray:
        """Mean of vectors at the nodes of a section, shapes (..., nodes of one, 3) and (..., 3)."""
        found = np.asarray(self._weights @ fields)
        if self._is_half:
            found[..., 2] = 0
        return found

    def _moment(self, fields: np.ndarray) -> np.ndarray:
        """Sum of w u (X - X_c)^T over the nodes of a section, shapes (..., nodes of one, 3) and (..., 3, 3)."""
        found = np.swapaxes(fields, -1, -2) @ self._weighted_arms
        if self._is_half:
            found[..., 2, :2] = found[..., :2, 2] = 0
        return found

    def quantities(self, displacement: np.ndarray, changes: np.ndarray) -> dict[str, np.ndarray]:
        """The sections' positions, rotations and corners, and their derivatives, as `schema` names and describes them.

        Args:
            displacement: of all nodes, shape (nodes, 3) [m].
            changes: its derivatives by p parameters, shape (p, nodes, 3) [m].
        """
        moved, change = self._on_sections(displacement), self._on_sections(changes)
        shift, shift_change = self._mean(moved), self._mean(change)
        rotation, stretch = rigid_motion.nearest_rotations(self._inertia + self._moment(moved))
        turn = rigid_motion.turns(rotation, stretch, self._moment(change))
        quaternion = rigid_motion.quaternions(rotation)
        arms = self._arms[:, self._corners]
        corners = (arms + moved[:, self._corners] - shift[:, None]) @ rotation  # rows R^T (x - c)
        corner_change = (change[:, :, self._corners] - shift_change[:, :, None]) @ rotation
        corner_change -= np.cross(turn[:, :, None], corners)
        derivatives = {
            "section_place": shift_change,
            "section_rotation": rigid_motion.quaternion_changes(quaternion, turn),
            "section_corners": corner_change * self._sides,
        }
        return {
            "section_place": self._centres + shift,
            "section_rotation": quaternion,
            "section_corners": (corners - arms) * self._sides,
            **{f"{name}_jacobian": np.moveaxis(values, 0, -1) for name, values in derivatives.items()},
        }
