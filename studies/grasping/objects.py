"""Objects to be picked up: a box, ball, cylinder, cone or convex mesh of random size, mass, friction and strength.

An object stands on z = 0, its middle above the origin, and is to be grasped at a height. Of every shape its corners
are known, those of a ball or cylinder up to 0.05 mm: from these comes how much the faces that fingers meet may lean,
wherever within the error of its pose it stands.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from control import Object

SHAPES = ("box", "sphere", "cylinder", "cone", "mesh")
POSE_ERROR = 0.004  # [m], most
WIDTH = 0.010  # of a plate [m]
ROUND = 48  # corners of a circle


@dataclass(frozen=True, kw_only=True)
class Thing:
    """What is to be picked up.

    Attributes:
        shape: one of SHAPES.
        size: MuJoCo's, of a box, ball or cylinder [m]; of others, none.
        corners: shape (n, 3) [m].
        grasped: height at which it is to be grasped [m].
        radius: its mean half-width there [m].
        mass, friction, admissible_force: [kg], [-], [N], see `control.Object`.
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
        """Height of its own frame's origin above its foot [m]: that of MuJoCo's primitives is their middle."""
        return 0.0 if not self.size else -float(self.corners[:, 2].min() - self.corners[:, 2].max()) / 2

    def held(self, directions: np.ndarray, random: np.random.Generator) -> Object:
        """As fingers have to hold it: its faces lean as much as they may where its pose is as wrong as it may be."""
        return Object(
            mass=self.mass,
            friction=self.friction,
            admissible_force=self.admissible_force,
            lean=self.lean(directions, random),
        )

    def lean(self, directions: np.ndarray, random: np.random.Generator, samples: int = 100) -> float:
        """Most that faces lean from the fingers' directions, shape (fingers, 2), over errors of its pose [rad]."""
        hull = ConvexHull(self.corners)
        normals, ends = hull.equations[:, :3], -hull.equations[:, 3]
        errors = random.standard_normal((samples, 3))
        errors *= POSE_ERROR / np.linalg.norm(errors, axis=1)[:, None]
        return max(_lean(normals, ends, direction, error, self.grasped) for error in errors for direction in directions)


def _lean(normals: np.ndarray, ends: np.ndarray, direction: np.ndarray, error: np.ndarray, height: float) -> float:
    """How much a face leans that a plate's edge from a direction touches first [rad]."""
    across, tiny = np.array([-direction[1], direction[0]]), 1e-5

    def out(aside: np.ndarray, above: float) -> np.ndarray:
        """How far the object reaches along the direction, beside it and above; -inf where it is not."""
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


def drawn(random: np.random.Generator, shape: str) -> Thing:
    """A random object of a shape."""
    size: tuple[float, ...] = ()
    height, radius = float(random.uniform(0.030, 0.045)), float(random.uniform(0.009, 0.016))
    grasped = height / 2
    around = 2 * np.pi * np.arange(ROUND) / ROUND
    circle = np.column_stack([np.cos(around), np.sin(around)])
    if shape == "box":
        size = radius, float(radius * random.uniform(0.8, 1.25)), height / 2
        signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
        corners = signs * size + [0, 0, height / 2]
        radius = (size[0] + size[1]) / 2
    elif shape == "sphere":
        radius = float(random.uniform(0.012, 0.018))
        size, grasped = (radius,), radius
        rings = [np.column_stack([circle * np.cos(a), np.full(ROUND, np.sin(a))]) for a in np.linspace(-1.5, 1.5, 49)]
        corners = radius * np.concatenate([*rings, [[0, 0, -1]], [[0, 0, 1]]]) + [0, 0, radius]
    elif shape == "cylinder":
        size = radius, height / 2
        corners = np.concatenate([np.column_stack([radius * circle, np.full(ROUND, z)]) for z in (0.0, height)])
    elif shape == "cone":
        lean = float(np.radians(random.uniform(4, 12)))
        foot, top = radius + 0.4 * height * np.tan(lean), radius - 0.6 * height * np.tan(lean)
        grasped = 0.4 * height
        corners = np.concatenate(
            [np.column_stack([r * circle, np.full(ROUND, z)]) for r, z in ((foot, 0.0), (top, height))]
        )
    elif shape == "mesh":
        points = random.standard_normal((40, 3))
        points /= np.linalg.norm(points, axis=1)[:, None]
        points *= [radius, radius * random.uniform(0.8, 1.25), height / 1.8]
        points[:, 2] = np.maximum(points[:, 2], -0.8 * height / 1.8)  # it stands
        corners = points[ConvexHull(points).vertices]
        middle = _centre(corners)
        corners -= [middle[0], middle[1], corners[:, 2].min()]
        grasped = float(_centre(corners)[2])
    else:
        raise ValueError(f"shape must be one of {SHAPES}, got {shape!r}")
    return Thing(
        shape=shape,
        size=size,
        corners=corners,
        grasped=grasped,
        radius=radius,
        mass=float(np.exp(random.uniform(*np.log([0.01, 0.3])))),
        friction=float(random.uniform(0.3, 1.0)),
        admissible_force=float(np.exp(random.uniform(*np.log([0.5, 10.0])))),
    )


def faced(thing: Thing, directions: np.ndarray, angles: int = 12) -> Thing:
    """Turned, for fingers from directions that turn instead, so that its faces lean least."""
    ways = [turned(thing, 2 * np.pi / len(directions) * k / angles) for k in range(angles)]
    return min(ways, key=lambda way: way.lean(directions, np.random.default_rng(0), samples=24))


def turned(thing: Thing, angle: float) -> Thing:
    """Turned about its axis [rad]."""
    rotation = Rotation.from_euler("z", angle)
    return Thing(**(vars(thing) | {"corners": rotation.apply(thing.corners)}))


def _centre(corners: np.ndarray) -> np.ndarray:
    """Of the volume of a convex body [m]."""
    hull = ConvexHull(corners)
    inner = corners.mean(axis=0)
    tetrahedra = corners[hull.simplices] - inner
    volumes = np.abs(np.linalg.det(tetrahedra))
    return inner + (volumes[:, None] * tetrahedra.sum(axis=1) / 4).sum(axis=0) / volumes.sum()
