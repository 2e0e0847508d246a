"""Chambers in the swept mesh: the cells that it lacks, and the facets around them."""

import numpy as np
from scipy.spatial import cKDTree

from fingerfem.scene.scene import Scene
from fingerfem.scene.sections import PlaneMesh
from fingerfem.scene.sections.plane_mesh import AROUND


def solid_cells(scene: Scene, section: PlaneMesh, lines: np.ndarray) -> np.ndarray:
    """Numbers of the cells outside all chambers: i of quadrilateral q is q (lines - 1) + i, ascending."""
    middles = (lines[1:] + lines[:-1]) / 2
    void = np.zeros((len(section.quads), len(middles)), bool)
    for chamber, cavity in zip(scene.chambers, scene.outline.cavities, strict=True):
        void |= np.outer(section.tags == cavity.tag, (middles > chamber.x[0]) & (middles < chamber.x[1]))
    return np.flatnonzero(~void.ravel())


def walls(scene: Scene, section: PlaneMesh, lines: np.ndarray, facets: np.ndarray) -> list[np.ndarray]:
    """Facets of every chamber's wall, among those with midpoints of shape (n, 3) [m] before sections are scaled."""
    if not scene.chambers:
        return []
    tree, facets_by_chamber = cKDTree(facets) if len(facets) else None, []
    for chamber, cavity in zip(scene.chambers, scene.outline.cavities, strict=True):
        wanted = _midpoints(section, cavity.tag, lines, chamber.x)
        near = [] if tree is None else tree.query_ball_point(wanted, scene.outline.tolerance)
        facets_by_chamber.append(np.unique(np.concatenate([np.zeros(0, int), *map(np.array, near)]).astype(int)))
    return facets_by_chamber


def _midpoints(section: PlaneMesh, tag: int, lines: np.ndarray, limits: list[float]) -> np.ndarray:
    """Midpoints of a chamber's wall, shape (n, 3) [m]: along its border in the section, and at its ends."""
    own = PlaneMesh(points=section.points, quads=section.quads[section.tags == tag], tags=section.tags[:0])
    middles = (lines[1:] + lines[:-1]) / 2
    middles = middles[(middles > limits[0]) & (middles < limits[1])]
    sides = section.points[own.border].mean(axis=1)
    across = np.concatenate([np.repeat(sides, len(middles), axis=0), np.tile(_centres(own), (2, 1))])
    along = np.concatenate([np.tile(middles, len(sides)), np.repeat(limits, len(own.quads))])
    return np.column_stack([along, across])


def _centres(mesh: PlaneMesh) -> np.ndarray:
    """Means of the quadrilaterals' corners, shape (quads, 2) [m]."""
    return np.asarray(mesh.points[mesh.quads[:, AROUND]].mean(axis=1))
