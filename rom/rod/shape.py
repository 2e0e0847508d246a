"""The shape of a finger: where its material points are, and how much shorter its tendons have become."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rom.brief import brief
from rom.elements.law import POSE
from rom.elements.march import march
from rom.elements.outline import CORNERS

if TYPE_CHECKING:
    from rom.rod.rod import Rod


@brief
@dataclass(frozen=True, kw_only=True)
class Placed:
    """An element where it is.

    Attributes:
        kind: of it.
        at: position of its distal section along the finger at rest, or of its plate's centre [m].
        length: from there to its proximal section at rest [m].
        place: of the distal section in space, shape (3,) [m].
        rotation: of its frame, shape (3, 3) [-].
        inputs: the trained tensions, then the wrench that it transmits, shape (t + 6,) [N, N m].
        values: of its law.
    """

    kind: str
    at: float
    length: float
    place: np.ndarray
    rotation: np.ndarray
    inputs: np.ndarray
    values: np.ndarray


def placed(rod: Rod, tensions: np.ndarray, wrenches: np.ndarray) -> list[list[Placed]]:
    """The elements of every segment, each from its plate to its clamp.

    Args:
        rod: the finger.
        tensions: shape (t,) [N].
        wrenches: on the plates in their own frames, shape (plates, 6) [N, N m].
    """
    plates, found = rod.place(tensions, wrenches), []
    ends = np.cumsum(rod.scene["geometry"]["segments"]) - rod.half_lengths[0]
    beyond, ahead = np.zeros(6), rod.half_lengths[0]
    for k in reversed(range(len(rod.segments))):
        segment = rod.segments[k]
        pulled = np.array([tensions[rod.names.index(name)] for name in segment.names])
        marched = march(segment.elements, pulled[None], (wrenches[k] + beyond)[None])
        at, own = ends[k], []
        for j, (kind, length) in enumerate(rod.pieces[k]):
            inputs = np.concatenate([pulled, marched.wrenches[0, j]])
            trained = np.zeros(rod.elements.tensions)
            np.add.at(trained, segment.trained, pulled)
            own.append(
                Placed(
                    kind=kind,
                    at=at,
                    length=length,
                    place=plates.centres[k] + plates.rotations[k] @ marched.sections[0][0, j],
                    rotation=plates.rotations[k] @ marched.sections[1][0, j],
                    inputs=np.concatenate([trained, marched.wrenches[0, j]]),
                    values=segment.elements[j].value(inputs[None])[0],
                )
            )
            at -= length
        found.append(own)
        beyond = marched.base[0].copy()
        beyond[3:] += np.cross([ahead, 0.0, 0.0], beyond[:3])  # about the centre of the plate that clamps it
    return found[::-1]


def shortenings(rod: Rod, elements: list[list[Placed]]) -> np.ndarray:
    """How much shorter every tendon has become between the clamp and its plate, shape (t,) [m]."""
    found = np.zeros(len(rod.names))
    for i, tendon in enumerate(rod.scene["tendons"]):
        column = POSE + rod.similarity.tendons[i]
        found[i] = sum(one.values[column] for segment in elements[: tendon["segment"]] for one in segment)
    return found


def points_in_space(rod: Rod, elements: list[list[Placed]], points: np.ndarray) -> np.ndarray:
    """Where material points are, shapes (n, 3) [m]: bilinear between the corners of their cross-sections.

    Args:
        rod: the finger.
        elements: where they are.
        points: at rest; those in a plate move with it.
    """
    found, half, ahead = np.empty_like(points), rod.half_lengths[1], rod.half_lengths[0]
    along = np.minimum(points[:, 0], elements[-1][0].at + ahead)  # round-off beyond the tip is the tip
    for x in np.unique(along):
        own = along == x
        one = next(
            one for segment in elements for one in reversed(segment) if x <= one.at + ahead * (one is segment[0])
        )
        distance = one.at - x
        if one is _its_segment(elements, one)[0] and distance <= ahead:
            seen = points[own] - [one.at, 0.0, 0.0]
        else:
            corners = rod.own.outlines[one.kind].corners(one.inputs[None], distance)[0]
            shares = np.prod(1 + CORNERS * points[own, None, 1:] / half, axis=2) / 4
            seen = shares @ corners
        found[own] = one.place + seen @ one.rotation.T
    return found


def _its_segment(elements: list[list[Placed]], one: Placed) -> list[Placed]:
    return next(segment for segment in elements if any(one is other for other in segment))
