"""What acts on a rod of PyElastica: the tendon in its channel, and the plane under the plate's far corners.

The first element lies in the clamp, the last one is the plate, and those between are rubber. The channel is at
`offset` along the first director of each element. Arrays are PyElastica's: positions (3, nodes) [m], directors
(3, 3, elements), forces (3, nodes) [N] in the world's axes, torques (3, elements) [N m] in the elements' own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import elastica
import numpy as np
from numba import njit


@dataclass(kw_only=True)
class Loads:
    """What is changed between steps, and read.

    Attributes:
        offset: of the tendon's channel from the axis [m].
        half: of the plate's side [m].
        stiffness: of the plane [N/m].
        tension: of the tendon [N].
        height: of the plane [m], infinite without one.
        force: of the plane in the last step [N].
    """

    offset: float
    half: float
    stiffness: float
    tension: float = 0.0
    height: float = math.inf
    force: float = 0.0


class Tendon(elastica.NoForces):
    """A string of constant tension through an eyelet in every element: its energy is tension times length."""

    def __init__(self, loads: Loads) -> None:
        super().__init__()
        self.loads = loads

    def apply_forces(self, system: elastica.CosseratRod, time: float = 0.0) -> None:
        """Add its forces and torques."""
        tendon, arrays = (self.loads.tension, self.loads.offset), _arrays(system)
        _pull(*arrays, tendon)


class Plane(elastica.NoForces):
    """A frictionless plane y = height that pushes the plate's two far corners back by a stiff spring."""

    def __init__(self, loads: Loads) -> None:
        super().__init__()
        self.loads = loads

    def apply_forces(self, system: elastica.CosseratRod, time: float = 0.0) -> None:
        """Add its forces and torques."""
        plane = self.loads.half, self.loads.height, self.loads.stiffness
        self.loads.force = _push(*_arrays(system), plane)


def _arrays(rod: elastica.CosseratRod) -> tuple[np.ndarray, ...]:
    return rod.position_collection, rod.director_collection, rod.external_forces, rod.external_torques


@njit(cache=True)
def _pull(
    position: np.ndarray,
    directors: np.ndarray,
    forces: np.ndarray,
    torques: np.ndarray,
    tendon: tuple[float, float],
) -> None:
    """Eyelets are in the middle of every element of rubber, at the clamp's face and at the plate's near face."""
    tension, offset = tendon
    last = directors.shape[2] - 1
    before = np.array([position[0, 1], position[1, 1] + offset, 0.0])  # in the clamp's face, fixed
    for k in range(1, last + 1):
        near = (position[:, k] + position[:, k + 1]) / 2 if k < last else position[:, k].copy()
        eyelet = near + offset * directors[0, :, k]
        way = eyelet - before
        pull = tension * way / np.sqrt(np.sum(way**2))
        _at(k, -pull, offset, directors, torques)
        if k > 1:
            _at(k - 1, pull, offset, directors, torques)
            _share(k - 1, pull, forces)
        if k < last:
            _share(k, -pull, forces)
        else:
            forces[:, k] -= pull
        before = eyelet


@njit(cache=True)
def _share(element: int, force: np.ndarray, forces: np.ndarray) -> None:
    forces[:, element] += force / 2
    forces[:, element + 1] += force / 2


@njit(cache=True)
def _at(element: int, force: np.ndarray, offset: float, directors: np.ndarray, torques: np.ndarray) -> None:
    """Torque of a force at an offset along the first director: in the element's axes that is (offset, 0, 0) x f."""
    torques[1, element] -= offset * np.sum(directors[2, :, element] * force)
    torques[2, element] += offset * np.sum(directors[1, :, element] * force)


@njit(cache=True)
def _push(
    position: np.ndarray,
    directors: np.ndarray,
    forces: np.ndarray,
    torques: np.ndarray,
    plane: tuple[float, float, float],
) -> float:
    half, height, stiffness = plane
    last, total = directors.shape[2] - 1, 0.0
    for side in (half, -half):
        deep = position[1, last + 1] + side * directors[0, 1, last] - height
        if deep > 0:
            push = np.array([0.0, -stiffness * deep, 0.0])
            forces[:, last + 1] += push
            _at(last, push, side, directors, torques)
            total += stiffness * deep
    return total
