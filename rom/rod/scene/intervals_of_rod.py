"""Materials along parts of the axis: whole sections of another modulus, whose elements are scaled to it."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from rom.dataset.geometry import rubber_of, sizes_of
from rom.elements.pieces import Piece, cut
from rom.elements.taper import TaperedRubber, tapered_pieces
from rom.elements.transition import hindered_share
from rom.files.checked_file import ModelError
from rom.rod.scene.materials_of_rod import along, modulus_of
from rom.rod.scene.section_of_rod import NEAR


class Interval(NamedTuple):
    """A part of the axis of another material: its name, both ends [m], and its modulus over the rubber's [-]."""

    name: str
    begin: float
    end: float
    modulus: float


def intervals_of(trained: Mapping[str, Any], scene: Mapping[str, Any], modulus: float) -> list[Interval]:
    """Return the intervals of a scene, along the axis.

    Args:
        trained: the elements' scene.
        scene: of the finger.
        modulus: of the finger's rubber over that of the elements [-].

    Raises:
        ModelError: another law, other ratios of its constants, an overlap, chambers, or elements of several materials.
    """
    intervals = list[Interval]()
    for one in scene.get("materials") or []:
        if one.get("x") is None:
            continue
        if others := along(trained):
            raise ModelError(
                f"materials.{one['name']}.x must be left out where elements are of several materials, got {one['x']} "
                f"beside {others[0]['name']}"
            )
        if chambers := scene.get("chambers"):
            raise ModelError(
                f"materials.{one['name']}.x must be left out of a rod with chambers, which end in its clamp piece, "
                f"got {one['x']} with {chambers[0]['name']}"
            )
        try:
            stiffer = modulus_of(trained["material"], one["material"])
        except ModelError as error:
            raise ModelError(f"materials.{one['name']}: {error}") from None
        begin, end = one["x"]
        intervals.append(Interval(one["name"], begin, end, stiffer / modulus))
    intervals.sort(key=lambda one: one.begin)
    for one, other in pairwise(intervals):
        if other.begin < one.end * (1 - NEAR):
            raise ModelError(f"materials.{other.name}.x must begin beyond {one.name}, {one.end:g} m, got {other.begin}")
    return intervals


def in_segment(intervals: Sequence[Interval], geometry: Mapping[str, Any], k: int) -> list[Interval]:
    """The parts of intervals in the rubber of segment k, from 0; ends are measured from its clamp."""
    begin, end = rubber_of(geometry)[k]
    near = NEAR * end
    parts = [
        one._replace(begin=max(one.begin, begin) - begin, end=min(one.end, end) - begin)
        for one in intervals
        if one.begin < end - near and one.end > begin + near
    ]
    # up to the ends of the segment, which are no boundaries between elements
    return [
        one._replace(
            begin=one.begin if one.begin > near else -np.inf,
            end=one.end if one.end < end - begin - near else np.inf,
        )
        for one in parts
    ]


def cuts_of(intervals: Sequence[Interval]) -> list[float]:
    """Distances from the segment's clamp at which its material changes, ascending [m]."""
    ends = np.array([end for one in intervals for end in (one.begin, one.end)])
    return np.unique(ends[np.isfinite(ends)]).tolist()


def with_materials(own: Sequence[Piece], intervals: Sequence[Interval]) -> list[Piece]:
    """Elements from plate to clamp with the materials of a segment's intervals, at whose ends elements end."""
    ends = np.cumsum([one.length for one in own[::-1]])[::-1]
    pieces = []
    for piece, end in zip(own, ends, strict=True):
        middle = end - piece.length / 2
        interval = next((one for one in intervals if one.begin < middle < one.end), None)
        pieces.append(piece if interval is None else piece._replace(material=interval.name, modulus=interval.modulus))
    moduli = [one.modulus for one in pieces]
    distal, proximal = [moduli[0], *moduli[:-1]], [*moduli[1:], moduli[-1]]
    return [
        one._replace(hindered=(hindered_share(one.modulus, before), hindered_share(one.modulus, behind)))
        for one, before, behind in zip(pieces, distal, proximal, strict=True)
    ]


def pieces_of(
    lengths: Mapping[str, tuple[float, float]], geometry: Mapping[str, Any], intervals: Sequence[Interval], parts: int
) -> list[list[Piece]]:
    """The elements of every segment, from its plate to its clamp.

    Args:
        lengths: shortest and longest of every kind of element [m].
        geometry: of the finger's scene.
        intervals: of other materials.
        parts: into which interior elements are cut.

    Raises:
        ModelError: the elements make no segment of this length, taper or division.
    """
    segments, half = [], geometry["plate"] / 2
    for k, (begin, end) in enumerate(pairwise(sizes_of(geometry).tolist())):
        rubber = TaperedRubber(begin, end, geometry["segments"][k] - end * half, half)
        own = in_segment(intervals, geometry, k)
        try:
            pieces = tapered_pieces(lengths, rubber, cuts_of(own))
        except ModelError as error:
            raise ModelError(f"geometry.segments.{k}: {error}") from None
        segments.append(cut(with_materials(pieces, own), parts))
    return segments
