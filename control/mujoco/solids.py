"""Solids to be picked up: boxes, balls, cylinders, cones and convex meshes of random size, mass, friction and strength.

A solid stands on z = 0, centred above the origin, and is grasped at a height. Polyhedra represent all shapes, with an
error of at most 0.05 mm. They have the normals of the touched faces, for poses within the error.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from control.grasping.grasp_forces import GRAVITY, Object
from rom.brief import brief

SHAPES = ("box", "sphere", "cylinder", "cone", "mesh")
AROUND_AXIS = ("sphere", "cylinder", "cone")  # are the same, however they are turned about it
POSE_ERROR = 0.004  # of a gripper above a solid, at most [m]
WIDTH = 0.010  # of a plate [m]
DOWNWARDS = np.array([1.0, 0.0, 0.0])  # in the axes of Object.faces
TOUCHES_TABLE = 1e-6  # height of corners on it [m]
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
        uncertain: largest errors of the gripper's position that a plan includes, along x, y, z [m]: semi-axes.
    """

    shape: str
    size: tuple[float, ...]
    corners: np.ndarray
    grasped: float
    radius: float
    mass: float
    friction: float
    admissible_force: float
    uncertain: tuple[float, float, float] = (POSE_ERROR, POSE_ERROR, POSE_ERROR)

    @property
    def middle(self) -> float:
        """Height of its frame's origin above its foot [m]; the origin of MuJoCo's primitives is their centre."""
        return float(np.ptp(self.corners[:, 2])) / 2 if self.size else 0.0

    @property
    def tipping_force(self) -> float:
        """Smallest horizontal force at the height of the grasp that tips it over [N]; 0 if it falls, inf for a ball."""
        if self.shape == "sphere":
            return float("inf")
        foot = self.corners[self.corners[:, 2] < TOUCHES_TABLE, :2]
        nearest = -float(ConvexHull(foot).equations[:, 2].max()) if len(foot) > 2 else 0.0
        return self.mass * GRAVITY * max(nearest, 0.0) / self.grasped

    @property
    def capacity(self) -> float:
        """Largest vertical force over a contact force on any face but the foot, with friction [-]: an upper bound.

        A contact force N along an inward normal n and friction of at most mu N across it have a vertical part of at
        most N (n_z + mu sqrt(1 - n_z^2)).
        """
        hull = ConvexHull(self.corners)
        rises = -hull.equations[self.corners[hull.simplices][:, :, 2].max(axis=1) > TOUCHES_TABLE, 2]
        return float(np.max(rises + self.friction * np.sqrt(1 - np.minimum(rises**2, 1.0))))

    def held(self, directions: np.ndarray, samples: int = 50) -> Object:
        """Return an object for fingers from directions, shape (fingers, 2), and faces for samples of the pose error."""
        faces = self.faces(directions, samples)
        return Object(mass=self.mass, friction=self.friction, admissible_force=self.admissible_force, faces=faces)

    def faces(self, directions: np.ndarray, samples: int = 50) -> np.ndarray:
        """Inward normals that plates from directions, shape (fingers, 2), touch first, over pose errors.

        Returns:
            Axes are those of `Object.faces`, shape (samples, fingers, 3) [-]; downwards where a finger misses.
        """
        random = np.random.default_rng(0)
        errors = np.array([random_error(random) for _ in range(samples)]) / POSE_ERROR * self.uncertain
        return self._touched(directions, errors)[0]

    def half_widths(self, directions: np.ndarray) -> np.ndarray:
        """Distances from the axis of the faces that plates from directions, shape (fingers, 2), touch without an error.

        Returns:
            Shape (fingers,) [m]; -inf where a finger misses.
        """
        return self._touched(directions, np.zeros((1, 3)))[1][0]

    def _touched(self, directions: np.ndarray, errors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Inward normals, shape (errors, fingers, 3) [-], and distances, shape (errors, fingers) [m], of touched faces.

        Errors of the pose, shape (errors, 3) [m].
        """
        planes = np.unique(ConvexHull(self.corners).equations.round(12), axis=0)  # of triangles
        found = [_faces(planes[:, :3], -planes[:, 3], one, errors, self.grasped) for one in directions]
        normals, distances = zip(*found, strict=True)
        return np.stack(normals, axis=1), np.stack(distances, axis=1)

    def turned(self, angle: float) -> Solid:
        """Return it turned about its axis by an angle [rad]."""
        return replace(self, corners=Rotation.from_euler("z", angle).apply(self.corners))

    def turns(self, fingers: int, angles: int = 12) -> list[float]:
        """Rotations relative to a number of fingers that differ for them [rad]."""
        if self.shape in AROUND_AXIS:
            return [0.0]
        return (2 * np.pi / fingers * np.arange(angles) / angles).tolist()

    def best_turn(self, directions: np.ndarray) -> float:
        """Rotation relative to the fingers that leaves most room between dropping and crushing, by `room` [rad]."""
        return max(self.turns(len(directions)), key=lambda way: self.turned(way).room(directions))

    def reach(self, directions: np.ndarray) -> float:
        """Largest distance of a corner from the axis, along directions of fingers, shape (fingers, 2) [m]."""
        return float((self.corners[:, :2] @ directions.T).max())

    def room(self, directions: np.ndarray, samples: int = 24) -> float:
        """Estimate the ratio of the contact forces at which fingers crush or push out a solid, and drop it [-].

        Forces of fingers from directions, shape (fingers, 2), are equal. Friction first balances their parts across
        the fingers. A negative ratio means that the solid slips.
        """
        faces = self.faces(directions, samples)
        aside = np.abs(faces[:, :, 1] * directions[:, 1] - faces[:, :, 2] * directions[:, 0])
        rises, left = -faces[:, :, 0], self.friction**2 - aside**2
        along = np.sign(left) * np.sqrt(np.abs(left) * (1 - rises**2))
        up, pushed = ((rises + sign * along).sum(axis=1) for sign in (1, -1))
        weight = self.mass * GRAVITY
        most = min(self.admissible_force, weight / max(float(pushed.max()), 1e-9))
        return most * float(up.min()) / weight


def _faces(
    normals: np.ndarray, ends: np.ndarray, direction: np.ndarray, errors: np.ndarray, height: float
) -> tuple[np.ndarray, np.ndarray]:
    """Inward normals of the faces that a plate's edge touches first, and distances from the axis, over pose errors.

    Returns:
        Shapes (errors, 3) [-] and (errors,) [m].
    """
    across, tiny = np.array([-direction[1], direction[0]]), 1e-5
    rate = normals[:, :2] @ direction
    ahead, behind = rate > 1e-9, rate < -1e-9

    def out(aside: np.ndarray, above: float) -> np.ndarray:
        """Reach of the solid at points beside the finger, shape (errors, n) [m]; -inf where it is not."""
        points = np.concatenate([aside[..., None] * across, np.full((*aside.shape, 1), above)], axis=-1)
        room = ends - (points - errors[:, None]) @ normals.T
        most = (room[..., ahead] / rate[ahead]).min(axis=-1)
        least = (room[..., behind] / rate[behind]).max(axis=-1)
        beside = (room[..., ~(ahead | behind)] < 0).any(axis=-1)
        return np.where((most < least) | beside, -np.inf, most)

    edge = np.broadcast_to(np.linspace(-WIDTH / 2, WIDTH / 2, 21), (len(errors), 21))
    reach = out(edge, height)
    first = reach.argmax(axis=1)[:, None]
    aside, farthest = (np.take_along_axis(one, first, axis=1) for one in (edge, reach))
    near = out(aside * (1 - 2 * tiny / WIDTH), height)
    at_corner = (first == 0) | (first == edge.shape[1] - 1)  # of the plate, which touches instead of its edge
    with np.errstate(invalid="ignore"):  # differences of -inf
        rises = (out(aside, height + tiny) - out(aside, height - tiny)) / (2 * tiny)
        falls = np.where(at_corner, -np.sign(aside) * (near - farthest) / tiny, 0.0)
    inward = np.concatenate([-rises, falls * across - direction], axis=1)
    misses = ~np.isfinite(inward).all(axis=1)
    inward[misses] = DOWNWARDS  # it passes by, or touches at the solid's upper or lower end
    return inward / np.linalg.norm(inward, axis=1)[:, None], farthest[:, 0]


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


def centre_of(corners: np.ndarray) -> np.ndarray:
    """Centre of the volume of the convex body of corners, shape (n, 3); shape (3,) [m]."""
    hull = ConvexHull(corners)
    inner = corners.mean(axis=0)
    tetrahedra = corners[hull.simplices] - inner
    volumes = np.abs(np.linalg.det(tetrahedra))
    return inner + (volumes[:, None] * tetrahedra.sum(axis=1) / 4).sum(axis=0) / volumes.sum()


def half_width(corners: np.ndarray, height: float) -> float:
    """Mean half-width of the convex body of corners, shape (n, 3), at a height [m].

    The mean half-width of a plane convex outline is its perimeter over 2 pi (Cauchy).
    """
    corner, other = (corners[ends] for ends in np.triu_indices(len(corners), 1))
    crosses = (corner[:, 2] - height) * (other[:, 2] - height) < 0
    share = ((height - corner[:, 2])[crosses] / (other - corner)[crosses, 2])[:, None]
    outline = ConvexHull((corner[crosses] + share * (other - corner)[crosses])[:, :2])
    return float(outline.area) / (2 * np.pi)  # in a plane, `area` is the perimeter


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
    middle = centre_of(corners)
    corners -= [middle[0], middle[1], corners[:, 2].min()]
    return (), corners, float(centre_of(corners)[2]), radius


_FORMS = {"box": _box, "sphere": _sphere, "cylinder": _cylinder, "cone": _cone, "mesh": _mesh}


def _circle(radius: float, height: float) -> np.ndarray:
    around = 2 * np.pi * np.arange(ROUND) / ROUND
    return np.column_stack([radius * np.cos(around), radius * np.sin(around), np.full(ROUND, height)])
