"""Quadrilaterals and their named groups from a file of Gmsh, format 4.1 or 2.2, in the plane (y, z)."""

import contextlib
import io
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from fingerfem.scene.sections.plane_mesh import AROUND, RUBBER, PlaneMesh, oriented
from fingerfem.scene.sections.section import POOREST

LARGEST = 1.0  # extent of a section [m]
FLAT = 1e-6  # x of nodes, and distance of two that are one node, over the extent [-]
LINES = ("vertex", "line")  # kinds of elements that are no part of the section


class FileMesh(NamedTuple):
    """Points, shape (points, 2) [m]; quadrilaterals in tensor order, shape (quads, 4); groups: their quadrilaterals."""

    points: np.ndarray
    quads: np.ndarray
    groups: dict[str, np.ndarray]


def read_gmsh(path: Path) -> FileMesh:
    """Read a section.

    Raises:
        ValueError: one line naming the file, the group or element, the rule and the value.
    """
    try:
        nodes, quads, groups = _elements(path)
        used, numbers = np.unique(quads, return_inverse=True)
        points = _plane(nodes[used])
        quads = oriented(numbers.reshape(-1, 4)[:, AROUND], points)
        _check_connected(points, quads)
        _check_quality(points, quads, groups)
    except ValueError as error:
        raise ValueError(f"file {path}: {error}") from None
    return FileMesh(points, quads, groups)


def _elements(path: Path) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    """Nodes, shape (nodes, 3) [m]; quadrilaterals with corners around them, shape (quads, 4); groups."""
    mesh = _read(path)
    kinds = [block.type for block in mesh.cells]
    for kind in sorted(set(kinds) - {"quad", *LINES}):
        count = sum(len(block.data) for block in mesh.cells if block.type == kind)
        raise ValueError(
            f"must have quadrilaterals of four nodes alone (in Gmsh: Recombine Surface, order 1), got {count} of {kind}"
        )
    physical = mesh.cell_data.get("gmsh:physical", [])
    names = {(int(dimension), int(tag)): name for name, (tag, dimension) in mesh.field_data.items()}
    lines = sorted(name for (dimension, _), name in names.items() if dimension != 2)
    if lines:
        raise ValueError(f"must have physical groups of surfaces alone, got {lines[0]!r} of points or lines")
    if len(physical) != len(kinds):
        raise ValueError("must have every element in a physical group, got none in any")
    of_quads = [k for k, kind in enumerate(kinds) if kind == "quad"]
    if not of_quads:
        raise ValueError("must have quadrilaterals in physical groups, got none")
    quads = np.concatenate([mesh.cells[k].data for k in of_quads])
    tags = np.concatenate([np.asarray(physical[k]) for k in of_quads])
    groups = {name: np.flatnonzero(tags == tag) for (_, tag), name in names.items()}
    nameless = sorted(set(tags.tolist()) - {tag for _, tag in names})
    if nameless:
        raise ValueError(f"must have names for all physical groups, got number {nameless[0]} without")
    if not len(groups.get("rubber", ())):
        raise ValueError(f"must have a physical group 'rubber', got {', '.join(map(repr, groups)) or 'none'}")
    _, first, times = np.unique(np.sort(quads, axis=1), axis=0, return_index=True, return_counts=True)
    if times.max() > 1:
        twice = int(first[times.argmax()])
        raise ValueError(
            f"must have every element once, in one group, got one of {_group_of(groups, twice)!r} {times.max()} times, "
            f"nodes {(quads[twice] + 1).tolist()}"
        )
    return np.asarray(mesh.points, float), quads, groups


def _read(path: Path) -> Any:
    try:
        import meshio  # read where a file names a section alone
    except ImportError:
        raise ValueError("needs meshio to be read (Debian: python3-meshio)") from None
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            return meshio.read(path, file_format="gmsh")
    except (Exception, SystemExit) as error:
        reason = str(error) or type(error).__name__
        if "gmsh:physical" in reason:  # some blocks have a group and others none
            raise ValueError("must have every element in a physical group (in Gmsh: Mesh.SaveAll = 0)") from None
        raise ValueError(f"must be a mesh of Gmsh, format 4.1 or 2.2, got {reason.splitlines()[0]}") from None


def _plane(nodes: np.ndarray) -> np.ndarray:
    """(y, z) of nodes in the plane x = 0, shape (nodes, 2) [m]."""
    extent = float(np.ptp(nodes, axis=0).max())
    if not 1e-6 <= extent <= LARGEST:
        raise ValueError(f"must be between 1e-6 and {LARGEST:g} m large, got {extent:g} m (a length in mm?)")
    off = int(np.abs(nodes[:, 0]).argmax())
    if abs(nodes[off, 0]) > FLAT * extent:
        raise ValueError(
            f"must lie in the plane x = 0, y up and z across the finger, got a node at {nodes[off].tolist()} m"
        )
    double = cKDTree(nodes).query_pairs(FLAT * extent, output_type="ndarray")
    if len(double):
        raise ValueError(
            f"must have one node at a point (in Gmsh: Coherence Mesh), got two at {nodes[double[0, 0]].tolist()} m"
        )
    return np.ascontiguousarray(nodes[:, 1:])


def _check_connected(points: np.ndarray, quads: np.ndarray) -> None:
    """Quadrilaterals hang together by edges."""
    around = quads[:, AROUND]
    pairs = np.sort(np.stack([around, np.roll(around, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    _, edge = np.unique(pairs, axis=0, return_inverse=True)
    edge, quad = edge.ravel(), np.repeat(np.arange(len(quads)), 4)
    touching = coo_matrix((np.ones(len(edge)), (quad, len(quads) + edge)), shape=(2 * len(pairs),) * 2)
    _, labels = connected_components(touching, directed=False)
    parts = len(set(labels[: len(quads)].tolist()))
    if parts > 1:
        raise ValueError(f"must be one piece whose elements share edges, got {parts} pieces")
    if np.bincount(edge).max() > 2:
        crowded = pairs[int(np.flatnonzero(np.bincount(edge)[edge] > 2)[0])]
        raise ValueError(f"must have at most two elements at an edge, got more at {points[crowded[0]].tolist()} m")


def _check_quality(points: np.ndarray, quads: np.ndarray, groups: dict[str, np.ndarray]) -> None:
    mesh = PlaneMesh(points=points, quads=quads, tags=np.full(len(quads), RUBBER))
    worst = int(mesh.scaled_jacobians.argmin())
    if mesh.scaled_jacobians[worst] < POOREST:
        raise ValueError(
            f"group {_group_of(groups, worst)!r}, quadrilateral {worst + 1}: must have a sine of at least {POOREST} at "
            f"every corner, got {mesh.scaled_jacobians[worst]:.3g} about y, z = {mesh.corners[worst].mean(axis=0)} m"
        )


def _group_of(groups: dict[str, np.ndarray], quad: int) -> str:
    return next((name for name, own in groups.items() if quad in own), "")
