"""The motion of a finger's cross-sections, from the displacement of its nodes.

A section is a plane of element boundaries across the axis. With the mean c of its nodes' positions x, its rotation R is
that of the polar decomposition M = R U of

    M = sum of w (x - c) (X - X_c)^T     [m^2],

and its position is where this rigid motion brings its point on the axis, c - R m, with m from there to X_c. The weights
w [-], of sum 1, are the integrals of the nodes' shape functions over the plane. X - X_c lies in the plane, so M has
rank 2; R is unique all the same, and `rigid_motion.turns` differentiates it.

Nodes within a chamber, where it is filled, have no weight: sections have one definition along the whole finger.

Half a finger, z >= 0, has whole sections: the mirror image has the same entries of c and M with an even number of z,
and the others cancel.
"""

import numpy as np
from scipy.spatial import cKDTree

from rom.dataset import rigid_motion
from rom.dataset.grid import levels
from rom.dataset.sections.plane_nodes import PlaneNodes


def positions_of(nodes: np.ndarray, order: int) -> np.ndarray:
    """Positions of cross-sections along the axis at rest, shape (sections,), by those of nodes, (nodes, 3) [m]."""
    return levels(nodes[:, 0])[0][::order]


class CrossSections:
    """The cross-sections of a finger: element boundaries along the axis, so no mid-planes of order 2.

    Args:
        nodes: of the finger at rest, sorted by x, then y, then z, shape (nodes, 3) [m]. The first section has all of
            the plane's.
        order: Lagrange order of the mesh.
        plane: the nodes of one section.

    Attributes:
        positions: along the axis at rest, shape (sections,) [m].

    Example:
        >>> nodes = np.array([[x, y, z] for x in (0, 0.01) for y in (-0.005, 0.005) for z in (-0.005, 0.005)])
        >>> plane = plane_nodes(nodes[:4, 1:], nodes[:4, 1:], np.array([[0, 2, 1, 3]]), np.full(2, 0.005), False)
        >>> sections = CrossSections(nodes, 1, plane)
        >>> sections.quantities(np.zeros((8, 3)), np.zeros((0, 8, 3)))["section_place"][:, 0]
        array([0.  , 0.01])
    """

    def __init__(self, nodes: np.ndarray, order: int, plane: PlaneNodes):
        self.positions, layers = positions_of(nodes, order), len(levels(nodes[:, 0])[0])
        own = plane.weights > 0
        _, at = cKDTree(nodes[: len(own), 1:]).query(nodes[:, 1:])
        self._kept = slice(None) if own.all() else own[at]
        self._shape, self._order, self._is_half = (layers, int(own.sum()), 3), order, plane.is_half
        self._weights = plane.weights[own]
        across = self._on_sections(nodes) * [0, 1, 1]
        middle = self._mean(across)
        self._arms = across - middle[:, None]
        self._weighted_arms = self._weights[:, None] * self._arms
        self._middle = middle
        self._centres = self.positions[:, None] * [1, 0, 0] + middle
        self._inertia = self._moment(self._arms)
        self._fit = plane.corners[:, :, own]
        self._corner_arms = self._corners(self._arms)

    def _on_sections(self, fields: np.ndarray) -> np.ndarray:
        """Vectors at all nodes by section, shapes (..., nodes, 3) and (..., sections, nodes of one, 3)."""
        own = fields[..., self._kept, :]
        return own.reshape(*fields.shape[:-2], *self._shape)[..., :: self._order, :, :]

    def _mean(self, fields: np.ndarray) -> np.ndarray:
        """Mean of vectors at the nodes of a section, shapes (..., nodes of one, 3) and (..., 3)."""
        mean = np.asarray(self._weights @ fields)
        if self._is_half:
            mean[..., 2] = 0
        return mean

    def _corners(self, fields: np.ndarray) -> np.ndarray:
        """Vectors at the corners of a section, shapes (..., nodes of one, 3) and (..., 4, 3)."""
        corners = np.asarray(self._fit[0] @ fields)
        return corners + self._fit[1] @ fields * [1, 1, -1] if self._is_half else corners

    def _moment(self, fields: np.ndarray) -> np.ndarray:
        """Sum of w u (X - X_c)^T over the nodes of a section, shapes (..., nodes of one, 3) and (..., 3, 3)."""
        moment = np.swapaxes(fields, -1, -2) @ self._weighted_arms
        if self._is_half:
            moment[..., 2, :2] = moment[..., :2, 2] = 0
        return moment

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
        corners = (self._corner_arms + self._corners(moved) - shift[:, None]) @ rotation  # rows R^T (x - c)
        corner_change = (self._corners(change) - shift_change[:, :, None]) @ rotation
        corner_change -= np.cross(turn[:, :, None], corners)
        swung = np.cross(turn, self._middle)  # of the mean about the axis, in the section's frame
        derivatives = {
            "section_place": shift_change - np.einsum("sij,psj->psi", rotation, swung),
            "section_rotation": rigid_motion.quaternion_changes(quaternion, turn),
            "section_corners": corner_change,
        }
        return {
            "section_place": self._centres + shift - np.einsum("sij,sj->si", rotation, self._middle),
            "section_rotation": quaternion,
            "section_corners": corners - self._corner_arms,
            **{f"{name}_jacobian": np.moveaxis(values, 0, -1) for name, values in derivatives.items()},
        }
