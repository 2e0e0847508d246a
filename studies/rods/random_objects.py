"""Random objects that touch a finger: its plate, or anywhere, rubber included."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.spatial.transform import Rotation

from rom import Rod, TouchedSegment
from studies.rods.full_order import Pressed, Table, rigid

SHAPES = "plane", "sphere", "cylinder", "box"
DISTANCE, AWAY = 0.1, 0.15  # of every object where it touches the free finger, and at most [m]
RADII, DEPTHS = (3e-3, 3e-2), (2e-4, 4e-3)  # of round objects; how far objects advance beyond touch [m]
SIDES, ROUNDING = (8e-3, 3e-2), (5e-4, 2e-3)  # of boxes [m]
LEANING = 0.1  # largest component of a plane's normal along the plate's axis; beyond, rubber is touched first [-]
TILT, EDGE = np.radians(40), 0.8  # of an object against the surface [rad]; beyond that share of a face, an edge is near
CLEAR = 1e-3  # least distance of an object from where the finger is clamped [m]


def tensions(finger: Rod, random: np.random.Generator) -> np.ndarray:
    """Random ones [N], shape (t,)."""
    lower, upper = np.array([[one.lower, one.upper] for one in finger.parameters]).T
    return np.asarray(random.uniform(lower, upper))


def logarithmic(random: np.random.Generator, ends: tuple[float, float]) -> float:
    """A random number between two ends, its logarithm uniformly distributed."""
    return float(np.exp(random.uniform(*np.log(ends))))


def touching(
    finger: Rod, pulled: np.ndarray, random: np.random.Generator, shape: str, point: np.ndarray, outward: np.ndarray
) -> Table:
    """A random obstacle of a shape that approaches a point, and touches the free finger where d is DISTANCE."""
    radius = logarithmic(random, RADII)
    own: dict[str, Table] = {
        "plane": {"normal": (-outward).tolist()},
        "sphere": {"radius": radius},
        "cylinder": {"radius": radius, "axis": np.cross(outward, random.standard_normal(3)).tolist()},
        "box": {
            "sides": random.uniform(*SIDES, 3).tolist(),
            "rounding": float(random.uniform(*ROUNDING)),
            "rotation": Rotation.random(random_state=random).as_rotvec().tolist(),
        },
    }
    centre = point + (radius * outward if "radius" in own[shape] else 0.0)
    table = {"shape": shape, "direction": outward.tolist(), "centre": centre.tolist(), **own[shape]}
    there = TouchedSegment(rod=finger, obstacle=rigid(table | {"distance": (-1.0, 1.0)}))
    touch = float(there.outputs(np.array([[*pulled, 1.0]]))[0, 4])
    moved = (centre + (touch - DISTANCE) * outward).tolist()
    return table | {"centre": moved, "distance": [1e-4, AWAY], "method": "penalty"}


def at_plate(finger: Rod, pulled: np.ndarray, random: np.random.Generator, shape: str) -> Table:
    """An obstacle that touches the free plate, mostly a corner, from any direction except behind."""
    free = finger.place(pulled)
    rotation, normal = free.rotations[-1], random.standard_normal(3)
    while not normal @ rotation[:, 0] < LEANING * np.linalg.norm(normal):
        normal = random.standard_normal(3)
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    corners = free.centres[-1] + (signs * finger.half_lengths) @ rotation.T
    return touching(
        finger, pulled, random, shape, corners[np.argmin(corners @ normal)], -normal / np.linalg.norm(normal)
    )


def anywhere(finger: Rod, pulled: np.ndarray, random: np.random.Generator, shape: str) -> Table:
    """An obstacle that touches the free finger at a random position from a fifth of its length on."""
    half, angle = finger.half_lengths[1], random.uniform(0, 2 * np.pi)
    ray = np.array([np.cos(angle), np.sin(angle)])
    across = ray * half / np.abs(ray).max()
    outward = np.where(np.abs(across) > EDGE * half, np.sign(across), 0.0)  # of a face, or between two
    section = finger.sections(pulled, at=[random.uniform(0.2, 1.0) * finger.rest[0]])
    point = section.centres[0] + section.rotations[0] @ [0.0, *across]
    outward = section.rotations[0] @ [0.0, *outward / np.linalg.norm(outward)]
    aside, tilt = np.cross(outward, random.standard_normal(3)), random.uniform(0, TILT)
    tilted = np.cos(tilt) * outward + np.sin(tilt) * aside / np.linalg.norm(aside)
    return touching(finger, pulled, random, shape, point, tilted)


def clear_of_clamp(finger: Rod, table: Table, d: float) -> bool:
    """True if an obstacle at d [m] is away from the clamped section."""
    from fingerfem.mechanics.obstacles import NUMPY, bodies
    from fingerfem.scene.obstacle import Obstacle

    half, along = finger.half_lengths[1], np.linspace(-1.0, 1.0, 21)
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]])
    outline = [((1 - s) * one + (1 + s) * two) / 2 for one, two in pairwise(corners) for s in along]
    y, z = half * np.array(outline).T
    (body,) = bodies(Obstacle.model_validate(table), half)
    return bool(body.signed_distance((0 * y, y, z), d, NUMPY).min() > CLEAR)


def on_plate(finger: Rod, random: np.random.Generator, shape: str) -> Pressed:
    """An object of a shape that advances from the plate by up to the largest depth."""
    pulled = tensions(finger, random)
    table = at_plate(finger, pulled, random, shape)
    return Pressed(pulled, [table], DISTANCE - DEPTHS[1] * random.random(), "wrenches")


def on_surface(finger: Rod, random: np.random.Generator, shape: str) -> Pressed | None:
    """An object of a shape that advances from anywhere by a random depth; None too near to the clamp."""
    pulled = tensions(finger, random)
    table, d = anywhere(finger, pulled, random, shape), DISTANCE - logarithmic(random, DEPTHS)
    return Pressed(pulled, [table], d) if clear_of_clamp(finger, table, d) else None
