"""Objects at random before the plate of a finger."""

from __future__ import annotations

import numpy as np

from rom import Cylinder, Plane, SegmentMap, Sphere
from rom.segment.objects import Object

LEANING = 0.1  # most of a normal's component along the plate's axis: beyond, the rubber touches first [-]
DISTANCE = 0.1  # of every object from where it touches the free plate at d = 0 [m]
HIGHEST = 0.05  # of d, over that [m]
RADII = 0.002, 0.05  # [m]
SHAPES = ("plane", "sphere", "cylinder")


def tensions(segment: SegmentMap, random: np.random.Generator) -> np.ndarray:
    """Random ones [N], shape (t,)."""
    t = segment.tensions
    lower, upper = segment.pose.lower[:t], segment.pose.upper[:t]
    return np.asarray(lower + random.random(t) * (upper - lower))


def placed(segment: SegmentMap, pulled: np.ndarray, random: np.random.Generator, shape: str) -> Object:
    """An object that touches the free plate's corner where d is DISTANCE, whichever way it lies there."""
    free = segment.place([*pulled, *np.zeros(6)])
    axis, normal = free.rotation[:, 0], random.standard_normal(3)
    while not normal @ axis < LEANING * np.linalg.norm(normal):
        normal = random.standard_normal(3)
    normal /= np.linalg.norm(normal)
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    places = free.centre + (signs * segment.half_lengths) @ free.rotation.T
    surface = places[np.argmin(places @ normal)] + DISTANCE * normal
    radius = float(np.exp(random.uniform(*np.log(RADII))))
    where = {"direction": tuple(-normal), "distances": (0.0, DISTANCE + HIGHEST)}
    if shape == "plane":
        return Plane(centre=tuple(surface), normal=tuple(normal), **where)
    centre = tuple(surface - radius * normal)
    if shape == "sphere":
        return Sphere(centre=centre, radius=radius, **where)
    return Cylinder(centre=centre, radius=radius, axis=tuple(np.cross(normal, random.standard_normal(3))), **where)
