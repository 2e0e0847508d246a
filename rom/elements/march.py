"""Elements in series, from a segment's plate to its clamp (a nonlinear transfer-matrix method)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rom.elements import rotation_vectors
from rom.elements.law import ElementMap


class Marched(NamedTuple):
    """A segment under wrenches on its plate, n states.

    Attributes:
        place: of the clamp's centre, seen from the plate, shape (n, 3) [m].
        rotation: of the clamp's frame, seen from the plate, shape (n, 3, 3) [-].
        wrenches: that every element transmits, in its distal section's frame, shape (n, elements, 6) [N, N m].
        base: the wrench on the clamp, in its frame about its centre, shape (n, 6) [N, N m].
        inside: whether every element's inputs lie in its box, shape (n,).
    """

    place: np.ndarray
    rotation: np.ndarray
    wrenches: np.ndarray
    base: np.ndarray
    inside: np.ndarray

    @property
    def plate(self) -> tuple[np.ndarray, np.ndarray]:
        """The plate's centre and frame seen from the clamp, shapes (n, 3) [m] and (n, 3, 3) [-]."""
        return -np.einsum("nji,nj->ni", self.rotation, self.place), np.swapaxes(self.rotation, 1, 2)


def march(elements: Sequence[ElementMap], tensions: np.ndarray, wrenches: np.ndarray) -> Marched:
    """March from the plate to the clamp.

    Args:
        elements: their laws at their lengths, from the plate to the clamp.
        tensions: shape (n, t) [N].
        wrenches: on the plate in its frame, shape (n, 6) [N, N m].
    """
    n, wrench = len(tensions), np.array(wrenches, float)
    place, rotation = np.zeros((n, 3)), np.tile(np.eye(3), (n, 1, 1))
    transmitted, inside = [], np.ones(n, bool)
    for element in elements:
        inputs = np.concatenate([tensions, wrench], axis=1)
        inside &= element.inside(inputs)
        transmitted.append(wrench)
        values = element.value(inputs)
        arm, turned = values[:, :3], rotation_vectors.matrices(values[:, 3:6])
        place = place + np.einsum("nij,nj->ni", rotation, arm)
        rotation = rotation @ turned
        force, moment = wrench[:, :3], wrench[:, 3:] - np.cross(arm, wrench[:, :3])
        wrench = np.concatenate([np.einsum("nji,nj->ni", turned, part) for part in (force, moment)], axis=1)
    return Marched(place, rotation, np.stack(transmitted, axis=1), wrench, inside)
