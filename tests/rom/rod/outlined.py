"""Fingers whose sections have other outlines than the bundled one's, on its laws; and their surfaces, sampled."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from rom import Cylinder, Hull, Plane, Rod, Sphere, TouchedSegment, box
from rom.dataset.sections.section_outline import BOX, SectionOutline
from rom.rod.compiled import evaluation
from rom.rod.objects.shapes import RigidObject

HALF = 0.005  # of the bundled finger's side [m]
HEXAGON = HALF * np.array([[np.cos(a), np.sin(a) / np.sin(np.pi / 3)] for a in np.pi / 3 * np.arange(6)])
OUTLINES = {
    "circle": SectionOutline.circle(HALF),
    "rounded square": SectionOutline(vertices=0.7 * HALF * BOX, radius=0.3 * HALF),
    "nearly a circle": SectionOutline(vertices=0.1 * HALF * BOX, radius=0.9 * HALF),
    "hexagon": SectionOutline(vertices=HEXAGON),
    "64 corners": SectionOutline.hull(SectionOutline.circle(HALF).points(64)),
}
FLAT = SectionOutline.rectangle(HALF, 0.6 * HALF)
SIDES = 2 * np.array([0.010, 0.008, 0.006])  # of a box [m]
ROUNDING = 1e-3  # of its edges [m]
ALONG = 400  # points of a slice


@cache
def rod_of(name: str) -> Rod:
    """The bundled finger with another outline."""
    bundled = TouchedSegment.load().rod
    return replace(bundled, elements=replace(bundled.elements, section=OUTLINES[name]))


@cache
def flat_rod() -> Rod:
    """The bundled finger as if its corners were those of a rectangle: contact as on a square, with two sizes."""
    bundled = TouchedSegment.load().rod
    outlines = {kind: replace(one, half=FLAT.box) for kind, one in bundled.elements.outlines.items()}
    return replace(bundled, elements=replace(bundled.elements, section=FLAT, outlines=outlines))


def obstacles(centre: np.ndarray, out: np.ndarray, random: np.random.Generator) -> list[RigidObject]:
    """A plane, a ball, a cylinder and a box that touch a point from outside when they are at d = 0."""
    where = {"direction": tuple(out), "distances": (-0.1, 0.1)}
    radius, axis = random.uniform(4e-3, 2e-2), np.cross(out, random.standard_normal(3))
    away = tuple(centre + radius * out)
    return [
        Plane(centre=tuple(centre), normal=tuple(-out), **where),
        Sphere(centre=away, radius=radius, **where),
        Cylinder(centre=away, radius=radius, axis=tuple(axis), **where),
        box(
            centre=tuple(centre + 0.014 * out), sides=tuple(SIDES), rotation=(0.0, 0.0, 0.0), rounding=ROUNDING, **where
        ),
    ]


def gaps(obstacle: RigidObject, d: float, points: np.ndarray) -> np.ndarray:
    """Distances of points, shape (..., 3) [m], from an object of `obstacles` at d [m]."""
    arms = points - np.array(obstacle.centre) - d * np.array(obstacle.direction)
    if isinstance(obstacle, Plane):
        return np.asarray(arms @ obstacle.normal)
    if isinstance(obstacle, Hull):
        beyond = np.abs(arms) - SIDES / 2 + ROUNDING
        within = np.minimum(beyond.max(axis=-1), 0.0)
        return np.asarray(np.linalg.norm(np.maximum(beyond, 0.0), axis=-1) + within - ROUNDING)
    if isinstance(obstacle, Cylinder):
        axis = np.array(obstacle.axis) / np.linalg.norm(obstacle.axis)
        arms = arms - (arms @ axis)[..., None] * axis
    return np.asarray(np.linalg.norm(arms, axis=-1) - obstacle.radius)


def slices(rod: Rod, sections: np.ndarray, which: Sequence[int], yz: np.ndarray, along: int) -> np.ndarray:
    """Points of slices between cross-sections, shapes (m, 4, 3) and (slices, along, n, 3) [m].

    They are bilinear in a section's corners, and deviate from that as a beam bends (Saint-Venant).

    Args:
        rod: the finger.
        sections: corners -y -z, -y z, y -z and y z.
        which: slices, by the section where they begin.
        yz: points of the outline at rest, shape (n, 2) [m].
        along: points of each slice.
    """
    outline = rod.segments[0].section
    b, c = (yz / outline.box).T
    weights = np.stack([(1 - b) * (1 - c), (1 - b) * (1 + c), (1 + b) * (1 - c), (1 + b) * (1 + c)], axis=1) / 4
    if outline.is_rectangle:  # relative to its corners, and across its faces alone
        level, across = np.diff(-(outline.box**2))[0], np.isclose(np.abs(yz), outline.box).T
    else:
        around, across = outline.points(1 << 14), np.ones((2, len(yz)), bool)
        level = np.mean(around[:, 0] ** 2 - around[:, 1] ** 2)
    along_y, along_z = across * (yz[:, 0] ** 2 - yz[:, 1] ** 2 - level) / np.prod(outline.box)
    share, found = np.linspace(0.0, 1.0, along)[:, None, None], []
    for k in which:
        ends = sections[k : k + 2]
        x = np.diff(ends.mean(axis=1), axis=0)[0]
        x /= np.linalg.norm(x)
        y = (ends[:, 2:] - ends[:, :2]).mean(axis=(0, 1))
        y -= (y @ x) * x
        y /= np.linalg.norm(y)
        widths = np.linalg.norm(ends[:, [1, 3, 2, 3]] - ends[:, [0, 2, 0, 1]], axis=2)
        bulges = (widths[:, ::2] - widths[:, 1::2]) / 8
        own = (1 - share) * (weights @ ends[0]) + share * (weights @ ends[1])
        chi = (1 - share) * bulges[0] + share * bulges[1]
        found.append(own + along_z[:, None] * chi[..., 1:] * np.cross(x, y) - along_y[:, None] * chi[..., :1] * y)
    return np.array(found)


def sampled_gap(rod: Rod, tensions: np.ndarray, wrench: np.ndarray, obstacle: RigidObject, d: float) -> float:
    """The least gap of sampled points of the rubber, without its last slice, finer and finer about the nearest [m]."""
    sections, outline = evaluation.sections(rod.struct, tensions, wrench)[0][:-1], rod.segments[0].section
    count, fine = 256, outline.points(1 << 18)
    every = range(len(sections) - 2)
    own = gaps(obstacle, d, slices(rod, sections, every, outline.points(count), 9))
    best, (k, _, at) = own.min(), np.unravel_index(own.argmin(), own.shape)
    near, middle, width = [j for j in (k - 1, k, k + 1) if j in every], at / count, 1 / count
    for _ in range(4):
        shares = middle + width * np.linspace(-2, 2, 33)
        yz = fine[np.round(shares * len(fine)).astype(int) % len(fine)]
        own = gaps(obstacle, d, slices(rod, sections, near, yz, ALONG + 1))
        middle, best, width = shares[np.unravel_index(own.argmin(), own.shape)[2]], min(best, own.min()), width / 8
    if outline.radius == 0:
        best = min(best, gaps(obstacle, d, slices(rod, sections, near, outline.vertices, ALONG + 1)).min())
    return float(best)
