"""The normal of the contact that touches first is continuous along faces and edges and past corners, of every shape."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rom import Cylinder, Hull, Plane, Sphere, TouchedSegment, box
from rom.rod.compiled.contacts import find_contacts
from rom.rod.objects.shapes import RigidObject
from tests.rom.elements import elastic_rod as rod

TOUCHED = 1e-11  # [m]
FINEST = 1e-9  # of a path's length, between two poses whose normals are compared [-]
LONG = 0.012  # half a path, so that it begins and ends beside the plate [m]
WHERE = {"centre": (0.0, 0.0, 0.0), "direction": (0.0, 1.0, 0.0)}
SHAPES = "plane", "sphere", "cylinder", "hull", "box", "box along the plate"


def shaped(shape: str, random: np.random.Generator) -> RigidObject:
    turned = Rotation.random(random_state=int(random.integers(2**31)))
    if shape == "plane":
        return Plane(normal=tuple(turned.apply([0, 1, 0])), **WHERE)
    if shape == "sphere":
        return Sphere(radius=0.004, **WHERE)
    if shape == "cylinder":
        return Cylinder(radius=0.003, axis=tuple(turned.apply([0, 0, 1])), **WHERE)
    if shape == "hull":
        vertices = random.standard_normal((12, 3))
        return Hull(vertices=0.006 * vertices / np.linalg.norm(vertices, axis=1)[:, None], **WHERE)
    rotation = tuple(turned.as_rotvec()) if shape == "box" else (0.0, 0.0, 0.0)
    return box(sides=(0.008, 0.012, 0.006), rotation=rotation, **WHERE)


def turned(obstacle: RigidObject, rotation: np.ndarray) -> RigidObject:
    """The same about its centre."""
    if isinstance(obstacle, Plane):
        return replace(obstacle, normal=tuple(rotation @ obstacle.normal))
    if isinstance(obstacle, Cylinder):
        return replace(obstacle, axis=tuple(rotation @ obstacle.axis))
    return replace(obstacle, vertices=obstacle.vertices @ rotation.T) if isinstance(obstacle, Hull) else obstacle


class Path:
    """A way of an object past a plate at rest, on which it turns, kept in touch with it.

    Args:
        model: the finger, and an object at d = 0.
        random: of the way.
        turns: by how much the object turns [rad].
    """

    def __init__(self, model: TouchedSegment, random: np.random.Generator, turns: float):
        self._model, self._tensions = model, np.full(len(model.rod.names), 5.0)
        self._nothing = np.zeros(6 * sum(map(len, model.rod.pieces)))
        self._back, across, self._axis = (one / np.linalg.norm(one) for one in random.standard_normal((3, 3)))
        self._along = np.cross(self._back, across) / np.linalg.norm(np.cross(self._back, across))
        self._turns, self.names = turns, set[int]()

    def normal(self, share: float) -> np.ndarray | None:
        """In the object's frame, at a share of the path, from -1 to 1; None if it passes the plate."""
        plate = self._model.rod.place(self._tensions)
        seen = Rotation.from_rotvec(share * self._turns * self._axis).as_matrix()  # of the plate, from the object
        rotation = plate.rotations[-1] @ seen.T
        model, away = replace(self._model, obstacle=turned(self._model.obstacle, rotation)), 0.06
        for _ in range(60):
            moved = plate.centres[-1] - rotation @ (LONG * share * self._along + away * self._back)
            found = find_contacts(model.touching, self._tensions, 0.0, moved, self._nothing)
            assert found is not None
            touching = np.flatnonzero(~found.rubber)
            if not len(touching):
                return None
            first = touching[np.argmin(found.gaps[touching])]
            gap, normal = found.gaps[first], rotation.T @ found.axes[first, 0]
            if abs(gap) < TOUCHED:
                self.names.add(found.labels[first][1])
                return normal
            if gap > 0 and normal @ self._back <= 1e-3:  # it passes, or grazes
                return None
            away -= gap / (normal @ self._back)
        return None


def largest_jump(path: Path, begin: float, end: float) -> float:
    """The change of the normal between two poses next to each other, where it changes most between two on a path."""
    first, last = path.normal(begin), path.normal(end)
    while first is not None and last is not None and end - begin > FINEST:
        between = (begin + end) / 2
        middle = path.normal(between)
        if middle is None:
            return 0.0
        if np.linalg.norm(middle - first) > np.linalg.norm(last - middle):
            end, last = between, middle
        else:
            begin, first = between, middle
    return 0.0 if first is None or last is None else float(np.linalg.norm(last - first))


def jumps(finger, shape: str, paths: int) -> tuple[list[float], set[int]]:
    random, found, names = np.random.default_rng(4), [], set()
    for k in range(paths):
        path = Path(TouchedSegment(rod=finger, obstacle=shaped(shape, random)), random, turns=0.5 * (k % 2))
        shares = np.linspace(-1, 1, 25)
        found += [largest_jump(path, *ends) for ends in itertools.pairwise(shares)]
        names |= path.names
    return found, names


@pytest.mark.parametrize("shape", SHAPES)
def test_no_normal_flips_along_a_face_or_an_edge_or_past_a_corner(finger, shape):
    assert rod.PLATE < rod.SIDE
    found, names = jumps(finger, shape, 8)
    assert max(found) < 1e-4
    # Of several corners and edges; a plane from most sides meets the rubber first.
    assert len(names) > {"sphere": 0, "plane": 1}.get(shape, 4)
