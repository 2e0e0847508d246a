"""Solids to be picked up: boxes, balls, cylinders, cones and convex meshes of random size, mass, friction and strength.

A solid stands on z = 0, centred above the origin, and is grasped at a height. Polyhedra represent all shapes, with an
error of at most 0.05 mm. They bound the inclination of the touched faces, for every pose within its error.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from control.grasping.grasp_forces import Object
from rom.brief import brief

SHAPES = ("box", "sphere", "cylinder", "cone", "mesh")
POSE_ERROR = 0.004  # of a gripper above a solid, at most [m]
WIDTH = 0.010  # of a plate [m]
ROUND = 48  # corners of a circle
BELOW = 0.002  # distance below its centre at which a ball is grasped [m]
STANDS = 0.8  # share of a mesh's lower half above its flat foot [-]


@brief
@dataclass(frozen=True, kw_only=True)
class Solid:
    """A solid to be picked up.

    Attributes:
        shape: one of SHAPES.
        size: MuJoCo's size of a box, ball or cylinder [m]; of others, empty.
        corners: shape (n, 3) [m].
        grasped: height of the grasp [m].
        radius: mean half-width at this height [m].
        mass: [kg].
        friction: [-].
        admissible_force: largest contact force of one finger without crushing [N].
    """

    shape: str
    size: tuple[float, ...]
    corners: np.ndarray
    grasped: float
    radius: float
    mass: float
    friction: float
    admissible_force: float

    @property
    def middle(self) -> float:
        """Height of its frame's origin above its foot [m]; the origin of MuJoCo's primitives is their centre."""
        return float(np.ptp(self.corners[:, 2])) / 2 if self.size else 0.0

    def held(self, directions: np.ndarray) -> Object:
        """Return an object for fingers from directions, shape (fingers, 2), with the largest inclination of faces."""
        return Object(
            mass=self.mass,
            friction=self.friction,
            admissible_force=self.admissible_force,
            lean=self.lean(directions),
        )

    def lean(self, directions: np.ndarray, samples: int = 100) -> float:
        """Largest inclination of faces to the fingers' directions, shape (fingers, 2), over pose errors [rad]."""
        hull = ConvexHull(self.corners)
        normals, ends = hull.equations[:, :3], -hull.equations[:, 3]
        errors = np.random.default_rng(0).standard_normal((samples, 3))
        errors *= POSE_ERROR / np.linalg.norm(errors, axis=1)[:, None]
        return max(_lean(normals, ends, direction, error, self.grasped) for error in errors for direction in directions)

    def turned(self, angle: float) -> Solid:
        """Return it turned about its axis by an angle [rad]."""
        return replace(self, corners=Rotation.from_euler("z", angle).apply(self.corners))

    def best_turn(self, directions: np.ndarray, angles: int = 12) -> float:
        """Rotation relative to the fingers with the smallest inclination of faces [rad]."""
        ways = 2 * np.pi / len(directions) * np.arange(angles) / angles
        return min(ways.tolist(), key=lambda way: self.turned(way).lean(directions, samples=24))


def _lean(normals: np.ndarray, ends: np.ndarray, direction: np.ndarray, error: np.ndarray, height: float) -> float:
    """How much a face leans that a plate's edge from a direction touches first [rad]."""
    across, tiny = np.array([-direction[1], direction[0]]), 1e-5

    def out(aside: np.ndarray, above: float) -> np.ndarray:
        """How far the solid reaches along the direction, beside it and above; -inf where it is not."""
        from_middle = np.column_stack([aside[:, None] * across, np.full(len(aside), above)]) - error
        rate, room = normals[:, :2] @ direction, ends - from_middle @ normals.T
        most = np.where(rate > 1e-9, room / np.where(rate > 1e-9, rate, 1.0), np.inf).min(axis=1)
        least = np.where(rate < -1e-9, room / np.where(rate < -1e-9, rate, -1.0), -np.inf).max(axis=1)
        beside = (np.abs(rate) <= 1e-9) & (room < 0)
        return np.where((most < least) | beside.any(axis=1), -np.inf, most)

    aside = np.linspace(-WIDTH / 2, WIDTH / 2, 21)
    reach = out(aside, height)
    if not np.isfinite(reach.max()):
        return np.pi / 2  # it passes by
    first = int(np.argmax(reach))
    up, down = (float(out(aside[[first]], height + sign * tiny)[0]) for sign in (1, -1))
    slopes = [(up - down) / (2 * tiny)]
    if first in (0, len(aside) - 1):  # a corner of the plate touches, not its edge
        near = out(aside[[first]] * (1 - 2 * tiny / WIDTH), height)[0]
        slopes.append(float(near - reach[first]) / tiny)
    return float(np.arctan(np.linalg.norm(slopes)))


def random_solid(random: np.random.Generator, shape: str) -> Solid:
    """Draw a random solid of a shape.

    Raises:
        ValueError: no such shape.
    """
    height, radius = float(random.uniform(0.030, 0.045)), float(random.uniform(0.009, 0.016))
    made = _FORMS.get(shape)
    if made is None:
        raise ValueError(f"shape must be one of {', '.join(SHAPES)}, got {shape!r}")
    size, corners, grasped, radius = made(random, height, radius)
    return Solid(
        shape=shape,
        size=size,
        corners=corners,
        grasped=grasped,
        radius=radius,
        mass=float(np.exp(random.uniform(*np.log([0.01, 0.3])))),
        friction=float(random.uniform(0.3, 1.0)),
        admissible_force=float(np.exp(random.uniform(*np.log([0.5, 10.0])))),
    )


def random_error(random: np.random.Generator) -> np.ndarray:
    """Draw a gripper's position error, uniform in the ball of radius POSE_ERROR, shape (3,) [m]."""
    error = random.standard_normal(3)
    return error * (POSE_ERROR * random.random() ** (1 / 3) / np.linalg.norm(error))


# MuJoCo's size, corners, height at which it is grasped, half-width there.
Form = tuple[tuple[float, ...], np.ndarray, float, float]


def _box(random: np.random.Generator, height: float, radius: float) -> Form:
    size = radius, float(radius * random.uniform(0.8, 1.25)), height / 2
    signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
    return size, signs * size + [0, 0, height / 2], height / 2, (size[0] + size[1]) / 2


def _sphere(random: np.random.Generator, height: float, radius: float) -> Form:
    radius = float(random.uniform(0.012, 0.018))
    rings = [_circle(np.cos(a), np.sin(a)) for a in np.linspace(-1.5, 1.5, 49)]
    corners = radius * np.concatenate([*rings, [[0, 0, -1]], [[0, 0, 1]]]) + [0, 0, radius]
    return (radius,), corners, radius - BELOW, radius


def _cylinder(random: np.random.Generator, height: float, radius: float) -> Form:
    corners = np.concatenate([_circle(radius, z) for z in (0.0, height)])
    return (radius, height / 2), corners, height / 2, radius


def _cone(random: np.random.Generator, height: float, radius: float) -> Form:
    grows, grasped = float(np.tan(np.radians(random.uniform(4, 12)))), 0.4 * height
    foot, top = radius + grasped * grows, radius - (height - grasped) * grows
    return (), np.concatenate([_circle(foot, 0.0), _circle(top, height)]), grasped, radius


def _mesh(random: np.random.Generator, height: float, radius: float) -> Form:
    points = random.standard_normal((40, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    points *= [radius, radius * random.uniform(0.8, 1.25), height / (1 + STANDS)]
    points[:, 2] = np.maximum(points[:, 2], -STANDS * height / (1 + STANDS))
    corners = points[ConvexHull(points).vertices]
    middle = _centre(corners)
    corners -= [middle[0], middle[1], corners[:, 2].min()]
    return (), corners, float(_centre(corners)[2]), radius


_FORMS = {"box": _box, "sphere": _sphere, "cylinder": _cylinder, "cone": _cone, "mesh": _mesh}


def _circle(radius: float, height: float) -> np.ndarray:
    around = 2 * np.pi * np.arange(ROUND) / ROUND
    return np.column_stack([radius * np.cos(around), radius * np.sin(around), np.full(ROUND, height)])


def _centre(corners: np.ndarray) -> np.ndarray:
    """Of the volume of a convex body [m]."""
    hull = ConvexHull(corners)
    inner = corners.mean(axis=0)
    tetrahedra = corners[hull.simplices] - inner
    volumes = np.abs(np.linalg.det(tetrahedra))
    return inner + (volumes[:, None] * tetrahedra.sum(axis=1) / 4).sum(axis=0) / volumes.sum()
