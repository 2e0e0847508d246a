"""Objects at random before the plate of a finger."""

from __future__ import annotations

import numpy as np

from rom import Cylinder, Plane, Rod, Sphere, TouchedSegment
from rom.rod.objects.shapes import RigidObject
from studies.rods.full_order import Table, obstacle, random_box

LEANING = 0.1  # most of a normal's component along the plate's axis: beyond, the rubber touches first [-]
DISTANCE = 0.1  # of every object from where it touches the free plate at d = 0 [m]
HIGHEST = 0.05  # of d, over that [m]
RADII = 0.002, 0.05  # [m]
SHAPES = ("plane", "sphere", "cylinder", "box")


def tensions(finger: Rod, random: np.random.Generator) -> np.ndarray:
    """Random ones [N], shape (t,)."""
    lower, upper = np.array([[one.lower, one.upper] for one in finger.parameters]).T
    return np.asarray(lower + random.random(len(lower)) * (upper - lower))


def placed(finger: Rod, pulled: np.ndarray, random: np.random.Generator, shape: str) -> tuple[RigidObject, Table]:
    """An object that touches the free plate where d is DISTANCE, whichever way it lies there, and its scene's table.

    It touches a corner of the plate, or as a box happens to be turned.
    """
    free = finger.place(pulled)
    centre, rotation = free.centres[-1], free.rotations[-1]
    axis, normal = rotation[:, 0], random.standard_normal(3)
    while not normal @ axis < LEANING * np.linalg.norm(normal):
        normal = random.standard_normal(3)
    normal /= np.linalg.norm(normal)
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    places = centre + (signs * finger.half_lengths) @ rotation.T
    corner = places[np.argmin(places @ normal)]
    surface = corner + DISTANCE * normal
    radius = float(np.exp(random.uniform(*np.log(RADII))))
    where: Table = {"direction": tuple(-normal), "distances": (0.0, DISTANCE + HIGHEST)}
    if shape == "box":
        return _box(finger, pulled, random, corner, where)
    found: RigidObject
    if shape == "plane":
        found = Plane(centre=tuple(surface), normal=tuple(normal), **where)
    elif shape == "sphere":
        found = Sphere(centre=tuple(surface - radius * normal), radius=radius, **where)
    else:
        along = tuple(np.cross(normal, random.standard_normal(3)))
        found = Cylinder(centre=tuple(surface - radius * normal), radius=radius, axis=along, **where)
    return found, obstacle(found)


def _box(finger: Rod, pulled: np.ndarray, random: np.random.Generator, corner: np.ndarray, where: Table) -> tuple:
    """A box that would hold the plate's corner in its middle at d = 0, moved back to touch it at DISTANCE."""
    state = random.bit_generator.state
    found, _ = random_box(random, tuple(corner), where | {"distances": (-1.0, 1.0)})
    touch = TouchedSegment(rod=finger, obstacle=found).outputs(np.array([*pulled, 0.5]))[0, 4]
    random.bit_generator.state = state
    found, own = random_box(random, tuple(corner + (touch - DISTANCE) * np.array(where["direction"])), where)
    return found, obstacle(found, own)
