"""Meshes of circles and rings: circles and radial lines around a square core, which a ring does not have.

A channel is a block of these cells, between two circles and two radial lines: as wide along both as a channel is, and
placed such that its centroid is its tendon's offset. Cells of order 2 have arcs as sides of the border. Those of order
1 have straight sides; their circles of the border are larger by the factor that makes the section's area exact.
"""

import math
from collections.abc import Iterable
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from fingerfem.scene.sections.core import BULGE, QUARTER, Core, core_grid, parts, radial_lines
from fingerfem.scene.sections.plane_mesh import RUBBER, PlaneMesh, oriented
from fingerfem.scene.sections.section import Wanted, check_quality
from fingerfem.scene.subdivision import SLIVER

ALIKE = 0.01  # of a channel's width: radial lines that are nearer to each other are one [-]
AWAY = 0.02  # of a channel's width: its centroid from its tendon, at most [-]
CORE, ON_CORE = 0.7, 0.85  # distance of the core's corner over the innermost circle's radius; mean radius over that [-]
STARTS = np.radians([45, 0, 22.5, 67.5, *range(5, 90, 5)])  # of a core's first corner, the better first [rad]
CLEAR = math.radians(5)  # of a core's corner from a channel's edge [rad]


class Sector(NamedTuple):
    """A channel beside the axis: radius [m] and angle [rad] of its tendon, half the angle it fills [rad], its tag."""

    radius: float
    angle: float
    half: float
    tag: int


class Limits(NamedTuple):
    """Inner and outer radius of a sector's cells [m]."""

    inner: float
    outer: float


def polar_mesh(wanted: Wanted, outer: float, inner: float) -> PlaneMesh:
    """The mesh of a circle, or of a ring whose inner radius [m] is above 0.

    Raises:
        ValueError: as `Section.mesh`.
    """
    step = 2 * outer / wanted.across
    unique = {column.tag: column for column in wanted.columns}
    beside = [column for column in unique.values() if np.hypot(*column.offset) > 0]
    central = [column.tag for column in unique.values() if np.hypot(*column.offset) == 0]
    sectors = [
        Sector(r := float(np.hypot(*one.offset)), math.atan2(*one.offset[::-1]), wanted.width / 2 / r, one.tag)
        for one in beside
    ]
    is_hollow = inner > 0 and not wanted.cavities
    angles = _angles(sectors, wanted, is_hollow, step / outer)
    grown = math.sqrt(2 * math.pi / np.sin(np.diff(np.append(angles, angles[0] + 2 * math.pi))).sum())
    limits = [_limits(sector, angles, wanted.width) for sector in sectors]
    ends = inner * (1.0 if wanted.curved and is_hollow else grown), outer * (1.0 if wanted.curved else grown)
    radii = _radii(limits, ends, AWAY * wanted.width, step)
    layers = radii[:, None, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    core = Core(layers[0], np.zeros((0, 4), int), np.arange(len(angles)))
    if not is_hollow:
        corner, bulge = (wanted.width / math.sqrt(2), 0.0) if central else (CORE * radii[0], BULGE)
        core = core_grid(angles, corner, bulge)
        count = max(1, round((radii[0] - ON_CORE * corner) / step))
        share = np.arange(count)[:, None, None] / count
        between = (1 - share) * core.points[core.border] + share * layers[0]
        layers, radii = np.concatenate([between, layers]), np.concatenate([np.zeros(count), radii])
    points, quads = _swept(core, layers)
    tags = np.full(len(quads), RUBBER)
    middle = [cavity.tag for cavity in wanted.cavities] or central
    tags[: len(core.quads)] = middle[0] if middle else RUBBER
    around = tags[len(core.quads) :].reshape(len(radii) - 1, len(angles))
    if wanted.cavities:
        around[radii[:-1] == 0] = middle[0]
    for sector, limit in zip(sectors, limits, strict=True):
        middles = (radii[1:] + radii[:-1]) / 2
        across = (middles > limit.inner) & (middles < limit.outer) & (radii[:-1] > 0)
        around[np.ix_(across, _inside(sector, angles))] = sector.tag
    return _checked(PlaneMesh(points=points, quads=quads, tags=tags, curved=wanted.curved), wanted, step)


def _angles(sectors: list[Sector], wanted: Wanted, is_hollow: bool, spacing: float) -> np.ndarray:
    """Angles of the radial lines, ascending over less than a turn [rad]."""
    fixed = [0.0, math.pi] if wanted.is_planar else []
    edges = [sector.angle + side * sector.half for sector in sectors for side in (-1, 1)]
    near = max((ALIKE * wanted.width / sector.radius for sector in sectors), default=0.0)
    if not is_hollow:
        start = STARTS[0] if wanted.is_planar else _start(sectors)
        lines = _merged(edges, [*fixed, *(start + QUARTER * np.arange(4))], near, start)

        def in_channel(angle: float) -> bool:
            return any(abs(math.remainder(angle - one.angle, 2 * math.pi)) < one.half for one in sectors)

        return radial_lines(lines, spacing, in_channel, wanted.is_planar)
    lines = _merged(edges, fixed, near, 0.0 if fixed else sectors[0].angle)
    ends = np.append(lines, lines[0] + 2 * math.pi)
    gaps = [np.linspace(a, b, parts(b - a, spacing), endpoint=False) for a, b in pairwise(ends.tolist())]
    return np.concatenate(gaps)


def _start(sectors: list[Sector]) -> float:
    """Angle of the core's first corner [rad]: no corner lies within a channel, or else none near a channel's edge."""

    def clearances(start: float) -> np.ndarray:
        """Angles of all corners from all channels, negative within one [rad]."""
        away = [
            abs(math.remainder(start + k * QUARTER - one.angle, 2 * math.pi)) - one.half
            for one in sectors
            for k in range(4)
        ]
        return np.array(away or [QUARTER])

    clear = [start for start in STARTS.tolist() if clearances(start).min() >= CLEAR]
    return clear[0] if clear else max(STARTS.tolist(), key=lambda start: float(np.abs(clearances(start)).min()))


def _merged(values: Iterable[float], fixed: Iterable[float], near: float, start: float) -> np.ndarray:
    """Angles as they follow each other from a start: those fixed, and means of others that are near each other."""

    def turned(value: float) -> float:
        angle = (value - start) % (2 * math.pi)
        return 0.0 if angle > 2 * math.pi - 1e-9 else angle

    kept = [turned(value) for value in fixed]
    groups: list[list[float]] = []
    for value in sorted(map(turned, values)):
        if any(abs(math.remainder(value - one, 2 * math.pi)) <= near for one in kept):
            continue
        if groups and value - groups[-1][-1] <= near:
            groups[-1].append(value)
        else:
            groups.append([value])
    return start + np.unique([*kept, *(float(np.mean(group)) for group in groups)])


def _inside(sector: Sector, angles: np.ndarray) -> np.ndarray:
    """True for cells, each between an angle and the next one, that belong to a sector, shape (angles,)."""
    middles = angles + np.diff(np.append(angles, angles[0] + 2 * math.pi)) / 2
    return np.asarray(np.abs(np.remainder(middles - sector.angle + math.pi, 2 * math.pi) - math.pi) < sector.half)


def _limits(sector: Sector, angles: np.ndarray, width: float) -> Limits:
    """Radii between which cells with straight sides have their centroid at the tendon.

    Cells between m - h and m + h have it at f (m + h^2 / 3 m), f of their angles alone.
    """
    own = _inside(sector, angles)
    wide = np.diff(np.append(angles, angles[0] + 2 * math.pi))[own]
    at = angles[own] + wide / 2
    weights = np.sin(wide) / np.sin(wide).sum() * np.cos(wide / 2)
    shrunk = float(np.hypot(weights @ np.cos(at), weights @ np.sin(at)))
    radius, half = sector.radius / shrunk, width / 2
    middle = (radius + math.sqrt(radius**2 - 4 * half**2 / 3)) / 2
    return Limits(middle - half, middle + half)


def _radii(limits: list[Limits], ends: tuple[float, float], away: float, step: float) -> np.ndarray:
    """Radii of the circles from the bore, or the innermost channel's, to the border [m].

    Circles that one circle replaces, no farther `away` [m] from any, are one.
    """
    inner, outer = ends
    kept = [inner, outer] if inner > 0 else [outer]
    groups: list[list[float]] = []
    for value in sorted(radius for limit in limits for radius in limit):
        if min(abs(value - one) for one in kept) <= away:
            continue
        if groups and value - groups[-1][0] <= 1.8 * away:
            groups[-1].append(value)
        else:
            groups.append([value])
    circles = sorted([*kept, *((group[0] + group[-1]) / 2 for group in groups)])
    gaps = [np.linspace(a, b, max(1, round((b - a) / step)), endpoint=False) for a, b in pairwise(circles)]
    return np.append(np.concatenate(gaps) if gaps else np.zeros(0), circles[-1])


def _swept(core: Core, layers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points and quadrilaterals of a core and of layers around it, shape (layers, angles, 2) [m], its border first."""
    count, around = layers.shape[:2]
    more = len(core.points) + np.arange((count - 1) * around).reshape(count - 1, around)
    numbers = np.concatenate([core.border[None], more])
    points = np.concatenate([core.points, layers[1:].reshape(-1, 2)])
    after = np.roll(numbers, -1, axis=1)
    quads = np.stack([numbers[:-1], numbers[1:], after[:-1], after[1:]], axis=-1).reshape(-1, 4)
    return points, np.concatenate([core.quads, oriented(quads, points)])


def _checked(mesh: PlaneMesh, wanted: Wanted, step: float) -> PlaneMesh:
    """The mesh, unless its cells are too thin or too far from rectangles, or a channel is not where its tendon is."""
    if mesh.edges.min() < step / SLIVER:
        raise ValueError(
            f"must not be forced to cells thinner than 1/{SLIVER} of the mean, {step:.3g} m, by channels that almost "
            f"touch each other or the border, got {mesh.edges.min():.3g} m"
        )
    for column in wanted.columns:
        away = float(np.linalg.norm(mesh.column_centroid(column.tag) - column.offset))
        if not away <= AWAY * wanted.width:
            raise ValueError(
                f"must give a channel whose centroid is within {AWAY} of its width of its tendon, {column.name}, "
                f"as more cells may do, got {away / wanted.width:.3g}"
            )
    return check_quality(mesh)
