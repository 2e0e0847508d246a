"""Grid lines along the axis that fit plates and pads at every resolution, and the section's mesh between them."""

import contextlib
import math

import numpy as np

from fingerfem.scene.outline import GridOutline
from fingerfem.scene.sections import PlaneMesh, check_cavities, material_of
from fingerfem.scene.subdivision import EQUAL, merged, subdivide
from fingerfem.scene.tables import Geometry, Mesh

FINE = 1000  # points between which sections of a tapered segment have one side
MORE = 40  # cells across that are tried where fewer do not fit
THINNEST = 1000  # side over shortest cell along the axis


def lines_along(outline: GridOutline, mesh: Mesh) -> np.ndarray:
    """Grid lines along x, shape (lines,) [m].

    Raises:
        ValueError: mesh.cells[0] cannot hold the plates or the pad.
    """
    try:
        lines = [_graded(outline.geometry, *segment) for segment in _with_cells(_along(outline), mesh.cells[0])]
    except ValueError as error:
        raise ValueError(f"mesh.cells[0] {error}") from None
    x = np.unique(np.concatenate(lines))
    if np.diff(x).min() < outline.geometry.side / THINNEST:
        raise ValueError(
            f"mesh.cells[0] must leave no cell shorter than 1/{THINNEST} of the side, "
            f"{outline.geometry.side / THINNEST:.3g} m, as a pad that ends beside a plate's face does, "
            f"got one of {np.diff(x).min():.3g} m"
        )
    # Longer cells lock in bending.
    share, of_side = (2 / 3, "two thirds of the side") if mesh.order == 1 else (1.0, "the side")
    of_side += "" if outline.geometry.shape.is_square else " of a square that bends alike"
    sides = outline.geometry.shape.depth * outline.geometry.size_at((x[1:] + x[:-1]) / 2)
    worst = int(np.argmax(np.diff(x) / sides))
    longest = share * sides[worst]
    if np.diff(x)[worst] > longest * (1 + 1e-6):
        raise ValueError(
            f"mesh.cells[0] must leave no cell of order {mesh.order} longer than {of_side}, {longest:.3g} m, "
            f"or bending locks, got one of {np.diff(x)[worst]:.3g} m"
        )
    return x


def section_mesh(outline: GridOutline, across: int, half: bool = False, order: int = 1) -> PlaneMesh:
    """The section's mesh at the clamp, of cells of an order; its half z >= 0 where half the finger is modelled.

    Raises:
        ValueError: the cells across cannot hold the channels or the pad, or a file is not of this finger.
    """
    section, wanted = outline.geometry.shape, outline.wanted(across, half, order)
    try:
        mesh = check_cavities(section.mesh(wanted), wanted.cavities)
        for inlay in wanted.inlays:
            material_of(mesh, inlay)
        return mesh
    except ValueError as error:
        raise ValueError(f"{section.meshed_by} {error}") from None


def materials_of_cells(outline: GridOutline, section: PlaneMesh, lines: np.ndarray) -> np.ndarray:
    """Number of the material of every quadrilateral between the lines along x, shape (quads, lines - 1).

    0 is the rubber, k the k-th of the other materials. Plates and chambers have numbers too, without a meaning.
    """
    middles = (lines[1:] + lines[:-1]) / 2
    numbers = np.zeros((len(section.quads), len(middles)), int)
    for k, (one, inlay) in enumerate(zip(outline.materials, outline.inlays, strict=True)):
        begin, end = (0.0, np.inf) if one.x is None else one.x
        numbers[np.ix_(material_of(section, inlay), (middles > begin) & (middles < end))] = k + 1
    return numbers


def _with_cells(segments: list[list[float]], along: int) -> list[tuple[list[float], int]]:
    """Each segment's breakpoints [m] and cells: the longest has `along`, the others cells of nearly the same length."""
    lengths = [one[-1] - one[0] for one in segments]
    shares = [math.ceil(along * length / max(lengths) * (1 - EQUAL)) for length in lengths]
    return [(one, max(cells, min(along, len(one) - 1))) for one, cells in zip(segments, shares, strict=True)]


def _graded(geometry: Geometry, breakpoints: list[float], cells: int) -> np.ndarray:
    """Grid lines of a segment along x [m], as even over the sections' own sides as possible."""
    if not geometry.is_tapered:
        return subdivide(breakpoints, cells)
    x = np.union1d(np.linspace(breakpoints[0], breakpoints[-1], FINE), breakpoints)
    sides = np.append(0.0, np.cumsum(np.diff(x) / geometry.size_at((x[1:] + x[:-1]) / 2)))
    fixed = np.interp(breakpoints, x, sides)
    lines = subdivide(fixed, cells)
    positions = np.interp(lines, sides, x)
    positions[np.searchsorted(lines, fixed)] = breakpoints
    return positions


def fitting(outline: GridOutline, across: int) -> int:
    """The fewest cells across, from the given number on, that fit channels and pad; that number if none does."""
    for cells in range(across, across + MORE):
        with contextlib.suppress(ValueError):
            section_mesh(outline, cells)
            return cells
    return across


def _along(outline: GridOutline) -> list[list[float]]:
    """Per segment, what must lie on grid lines along x [m]."""
    ends = outline.plates
    parts = [outline.pad, *outline.chambers, *outline.materials]
    edges = [edge for part in parts if part is not None and part.x is not None for edge in part.x]
    segments = []
    for start, (inner, outer) in zip([0.0, *[outer for _, outer in ends[:-1]]], ends, strict=True):
        inside = [edge for edge in edges if start < edge < outer]
        segments.append(merged([start, inner, outer], inside, EQUAL * outline.geometry.side))
    return segments


def in_plate(outline: GridOutline, k: int, x: np.ndarray) -> np.ndarray:
    """True for points x, shape (3, n) [m], in plate k, its faces included."""
    start, end = outline.plates[k]
    return (x[0] > start - outline.tolerance) & (x[0] < end + outline.tolerance)
