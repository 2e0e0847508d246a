"""The shape of a finger: where its cross-sections and material points are."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from rom.brief import brief
from rom.dataset.geometry import size_at
from rom.dataset.grid import SHARE
from rom.elements import rotation_vectors
from rom.elements.elements import INTERIOR
from rom.elements.law import POSE
from rom.elements.outline import CORNERS
from rom.elements.pieces import Piece
from rom.files.checked_file import ModelError
from rom.rod.compiled import reports

if TYPE_CHECKING:
    from rom.rod.rod import Rod


@brief
@dataclass(frozen=True, kw_only=True)
class Placed:
    """An element where it is.

    Attributes:
        piece: its kind, length and sizes.
        at: position of its distal section along the finger at rest, or of its plate's centre [m].
        half: of its plate, in which sections do not deform [m]; 0 of others.
        place: of the distal section in space, shape (3,) [m].
        rotation: of its frame, shape (3, 3) [-].
        proximal: place and rotation of the proximal section in space, likewise.
        inputs: the trained tensions, then the wrench that it transmits, shape (t + 6,) [N, N m].
    """

    piece: Piece
    at: float
    half: float
    place: np.ndarray
    rotation: np.ndarray
    proximal: tuple[np.ndarray, np.ndarray]
    inputs: np.ndarray

    @property
    def length(self) -> float:
        """Length from there to its proximal section at rest [m]."""
        return self.piece.length

    @property
    def stretch(self) -> float:
        """Length of the rubber's axis over that at rest, as an arc of a circle [-]."""
        centre, turned = self.proximal
        chord = float(np.linalg.norm(self.place - self.half * self.rotation[:, 0] - centre))
        half = float(rotation_vectors.angles(self.rotation, turned)) / 2
        return chord / float(np.sinc(half / np.pi)) / (self.length - self.half)


def placed(rod: Rod, tensions: np.ndarray, wrenches: np.ndarray) -> list[Placed]:
    """The elements of a finger from clamp to tip.

    Args:
        rod: the finger.
        tensions: shape (t,) [N].
        wrenches: on the plates in their own frames, shape (plates, 6) [N, N m].
    """
    at = 0.0
    before, elements = (np.zeros(3), np.eye(3)), list[Placed]()
    for k, sections in enumerate(reports.elements(rod.struct, tensions, wrenches)):
        segment, trained = rod.segments[k], np.zeros(rod.elements.tensions)
        half = segment.half_lengths[0]
        np.add.at(trained, segment.trained, [tensions[rod.names.index(name)] for name in segment.names])
        whole = list(zip(rod.pieces[k], *sections, strict=True))
        for piece, place, rotation, wrench in whole[::-1]:
            at += piece.length
            elements.append(
                Placed(
                    piece=piece,
                    at=at,
                    half=half if wrench is whole[0][-1] else 0.0,
                    place=place,
                    rotation=rotation,
                    proximal=before,
                    inputs=np.concatenate([trained, wrench]),
                )
            )
            before = place, rotation
        at += half
        before = place + half * rotation[:, 0], rotation
    return elements


def displacements(rod: Rod, elements: list[Placed], points: np.ndarray) -> np.ndarray:
    """Displacements of material points at rest, shapes (n, 3) [m]: bilinear between their cross-sections' corners.

    Points in a plate move with it.

    Args:
        rod: the finger.
        elements: where they are.
        points: at rest.

    Raises:
        ModelError: a point that is none of the finger.
    """
    length = sum(rod.scene["geometry"]["segments"])
    if points.ndim != 2 or points.shape[1] != 3 or _outside(points, length, half_at(rod, points[:, 0])):
        raise ModelError(f"points must lie in the finger at rest, shape (points, 3), got {points.tolist()[:1]}")
    positions = np.empty_like(points)
    for x in np.unique(points[:, 0]):
        own, one = points[:, 0] == x, _at(elements, x)
        if one.half and one.at - x <= one.half * (1 + SHARE):
            seen = points[own] - [one.at, 0.0, 0.0]
        else:
            shares = np.prod(1 + CORNERS * points[own, None, 1:] / half_at(rod, x), axis=2) / 4
            seen = shares @ _corners(rod, one, one.at - x)
        positions[own] = one.place + seen @ one.rotation.T
    return positions - points


@brief
class Sections(NamedTuple):
    """Poses of m cross-sections.

    Attributes:
        at: their positions along the finger at rest, shape (m,) [m].
        centres: mean positions in space, shape (m, 3) [m].
        rotations: of their frames, shape (m, 3, 3) [-]: columns are the directions of x, y and z at rest.
    """

    at: np.ndarray
    centres: np.ndarray
    rotations: np.ndarray


def sections(rod: Rod, elements: list[Placed], at: np.ndarray) -> Sections:
    """Poses of cross-sections at positions, shape (m,) [m].

    Each is seen from the distal section of its element, as `_estimate` has it. By how much that differs from the
    element's own law at its two ends is taken off linearly between these: sections of an interior element are exact.

    Raises:
        ModelError: a position that is none of the finger.
    """
    length = sum(rod.scene["geometry"]["segments"])
    if at.ndim != 1 or _outside(at[:, None], length, 0.0):
        raise ModelError(f"at must lie between clamp and tip, 0 to {length:g} m, got {at.tolist()[:1]}")
    centres, turned = np.empty((len(at), 3)), np.empty((len(at), 3, 3))
    for k, x in enumerate(at):
        one = _at(elements, x)
        if one.at - x <= one.half * (1 + SHARE):
            seen, relative = np.array([x - one.at, 0.0, 0.0]), np.eye(3)
        else:
            seen, relative = _seen(rod, one, one.at - x)
        centres[k], turned[k] = one.place + one.rotation @ seen, one.rotation @ relative
    return Sections(at, centres, turned)


def _seen(rod: Rod, one: Placed, distance: float) -> tuple[np.ndarray, np.ndarray]:
    """A section's centre and rotation, seen from the distal section of its element, at a distance from that [m]."""
    centre, turned = one.proximal
    ends = [
        (one.half, np.array([-one.half, 0.0, 0.0]), np.eye(3)),
        (one.length, one.rotation.T @ (centre - one.place), one.rotation.T @ turned),
    ]
    share = (distance - one.half) / (one.length - one.half)
    place, rotation = _estimate(rod, one, distance)
    turn = np.zeros(3)
    for weight, (end, own_place, own_rotation) in zip((1 - share, share), ends, strict=True):
        end_place, end_rotation = _estimate(rod, one, end)
        place = place + weight * (own_place - end_place)
        turn += weight * rotation_vectors.vectors(end_rotation.T @ own_rotation)
    return place, rotation @ rotation_vectors.matrices(turn)


def _estimate(rod: Rod, one: Placed, distance: float) -> tuple[np.ndarray, np.ndarray]:
    """A section's pose as if its element were an interior one; by its corners where there is none of that length."""
    law, length = rod.scaled(one.piece).laws.get(INTERIOR), distance - one.half
    if law is None or one.length - one.half > law.lengths[1] * (1 + SHARE):
        return _fit(rod, one, distance)
    face, inputs = np.array([-one.half, 0.0, 0.0]), one.inputs.copy()
    inputs[-3:] -= np.cross(face, inputs[-6:-3])  # the wrench about the centre of the plate's face
    pose = law.of_length(max(length, 0.0)).value(inputs[None])[0]
    return face + pose[:3], rotation_vectors.matrices(pose[3:POSE])


def _fit(rod: Rod, one: Placed, distance: float) -> tuple[np.ndarray, np.ndarray]:
    """The rigid motion that fits a section's corners best, seen from its element's distal section (Kabsch 1976)."""
    corners, rest = _corners(rod, one, distance), half_at(rod, one.at - distance) * CORNERS
    centre = corners.mean(axis=0)
    left, _, right = np.linalg.svd(np.insert(rest, 0, 0.0, axis=1).T @ (corners - centre))
    sign = np.linalg.det(left @ right)
    return centre, right.T @ np.diag([1.0, 1.0, sign]) @ left.T


def _corners(rod: Rod, one: Placed, distance: float) -> np.ndarray:
    """Corners of a section at a distance from its element's distal section [m], seen from that; shape (4, 3) [m]."""
    law = replace(rod.scaled(one.piece).outlines[one.piece.kind], half=half_at(rod, one.at - distance))
    return law.corners(one.inputs[None], distance)[0]


def half_at(rod: Rod, x: ArrayLike) -> np.ndarray:
    """Halves along y and z of the boxes of the sections at x along the finger at rest, shape (..., 2) [m]."""
    return size_at(rod.scene["geometry"], np.asarray(x))[..., None] * rod.own.section.box


def edges(rod: Rod) -> np.ndarray:
    """Points of the long edges at rest, every half side of the clamp's section, shape (points, 3) [m].

    A section without corners has as many lines along its border.
    """
    length, section = sum(rod.scene["geometry"]["segments"]), rod.own.section
    along = np.linspace(0.0, length, round(length / section.box.max()) + 1)
    border = section.support(section.box * CORNERS) if section.radius or section.is_rectangle else section.vertices
    points = size_at(rod.scene["geometry"], along)[:, None, None] * border
    return np.concatenate([np.repeat(along, len(border))[:, None], points.reshape(-1, 2)], axis=1)


def _outside(points: np.ndarray, length: float, half: ArrayLike) -> bool:
    """True if points or positions at rest, shape (n, 3) or (n, 1) [m], are not all in the finger."""
    along, across = np.abs(points[:, 0] - length / 2) * 2 / length, np.abs(points[:, 1:])
    return not ((along <= 1 + SHARE).all() and (across <= np.asarray(half) * (1 + SHARE)).all())


def _at(elements: list[Placed], x: float) -> Placed:
    """The element that a position is in [m]; round-off beyond the tip is the tip."""
    return next((one for one in elements if x <= one.at + one.half), elements[-1])
