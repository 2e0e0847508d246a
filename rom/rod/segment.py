"""A segment of a finger: elements in series from its plate to its clamp, and the plate."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rom.brief import brief
from rom.dataset.sections.section import area
from rom.dataset.sections.section_outline import SectionOutline
from rom.elements.elements import INTERIOR, Elements
from rom.elements.law import POSE, ElementMap, on_tensions
from rom.elements.pieces import Piece
from rom.elements.polynomial import Polynomial
from rom.elements.taper import shear_by_bending, tapered
from rom.elements.transition import with_transitions
from rom.files.checked_file import ModelError
from rom.native import PickledByFields
from rom.rod import compiled
from rom.rod.bulges import bulges_of

UNDER = 0.4  # over half the side: largest depth of a tendon that raises a ridge on the face above it [-]


@brief
@dataclass(frozen=True, kw_only=True)
class Segment(PickledByFields):
    """One segment of a finger, condensed to its plate when it is asked for.

    Attributes:
        elements: laws by the segment's loads and the wrench that each transmits, from the plate to the clamp: pose,
            then strokes of the trained actuators. Elements that share a law are one object.
        outlines: of every element, shared as its law is.
        names: of its tensions, then of its pressures.
        trained: which trained load each of these is.
        offsets: of the tendons in channels from the axis along y and z, shape (t, 2) [m]; 0 of those without a channel.
        half_lengths: of the plate along its own axes, shape (3,) [m].
        section: outline of the plate's section at rest.
        area: of the section at the plate [m^2].
        begins: size of the section where it begins over that of the plate's [-].
        length: from the clamp to the plate's centre at rest [m].
        moduli: of every element's material over that of the segment's rubber, shape (elements,) [-].
        bulges: see `bulges_of`; None without chambers.
        rubber: Young's modulus [Pa] and Poisson's ratio [-] of the rubber among other materials, which touches; None if
            it is alone.
    """

    elements: Sequence[ElementMap]
    outlines: Sequence[compiled.Outline]
    names: Sequence[str]
    trained: Sequence[int]
    offsets: np.ndarray
    half_lengths: np.ndarray
    section: SectionOutline
    area: float
    length: float
    moduli: Sequence[float]
    begins: float = 1.0
    bulges: np.ndarray | None = None
    rubber: tuple[float, float] | None = None

    @property
    def tensions(self) -> int:
        """Number of tensions."""
        return len(self.names)

    @property
    def rest(self) -> np.ndarray:
        """The plate's centre in the undeformed segment, seen from the clamp, shape (3,) [m]."""
        return np.array([self.length, 0.0, 0.0])

    @cached_property
    def young_modulus(self) -> float:
        """Young's modulus of the rubber at small strain [Pa]; if not stored, as the middle element stretches."""
        if self.rubber is not None:
            return self.rubber[0]
        k, pull, area = self._middle
        inputs = np.zeros((2, self.tensions + 6))
        inputs[:, -6] = -pull, pull
        longer = self.moduli[k] * np.ptp(self.elements[k].value(inputs)[:, 0])
        rubber = self.outlines[k].length - (0.0 if k else self.half_lengths[0])
        return float(2 * pull * rubber / (longer * area))

    @cached_property
    def poisson(self) -> float:
        """Poisson's ratio of the rubber at small strain, as the middle element thins where it is pulled [-]."""
        if self.rubber is not None:
            return self.rubber[1]
        k, pull, area = self._middle
        outline = self.outlines[k]
        inputs = np.zeros((2, len(outline.polynomial.lower)))
        inputs[:, -6] = -pull, pull
        corners = outline.polynomial.value(inputs).reshape(2, -1, 4, 3)
        pressed, pulled = (corners[:, :, 2:, 1] - corners[:, :, :2, 1]).mean(axis=(1, 2))
        strain = 2 * pull / (self.moduli[k] * self.young_modulus * area)
        return float((pressed - pulled) / (0.5 * (pressed + pulled)) / strain)

    @property
    def _middle(self) -> tuple[int, float, float]:
        """The middle element, which plates and the clamp hinder least; a small force [N]; its mean section [m^2]."""
        k = len(self.elements) // 2
        ends = np.cumsum([0.0, *(one.length for one in self.outlines)])[k : k + 2]
        shares = np.maximum(ends - self.half_lengths[0], 0.0) / (self.length - self.half_lengths[0])
        sizes = 1 + (self.begins - 1) * shares
        # 1 / area has the mean of that of all its sections
        return k, 1e-3 * float(self.elements[k].polynomial.upper[-6]), self.area * float(sizes.prod())

    @cached_property
    def depths(self) -> np.ndarray:
        """Sides of squares that bend as the plate's section does towards y and z, (12 I)^(1/4), shape (2,) [m].

        The second moments I are those that the middle element's law has at small moments.
        """
        k, t = len(self.elements) // 2, self.tensions
        sides = []
        for axis in (2, 1):  # a moment about z bends towards y
            moment = 1e-3 * self.elements[k].polynomial.upper[-3 + axis]
            inputs = np.zeros((2, t + 6))
            inputs[:, t + 3 + axis] = -moment, moment
            turn = 2 * np.ptp(self.elements[k].value(inputs)[:, 3 + axis])
            modulus = self.moduli[k] * self.young_modulus
            sides.append((24 * moment * self.outlines[k].length / (turn * modulus)) ** 0.25)
        return np.array(sides) * 2 / (1 + self.begins)

    @property
    def ridges(self) -> np.ndarray:
        """Heights of ridges above the tendons, see `CondensedSegment`; none on an outline without faces."""
        if not self.section.is_rectangle:
            return np.zeros((self.tensions, 2))
        under = np.abs(self.offsets) > (1 - UNDER) * self.half_lengths[1:]
        return np.where(under, np.sign(self.offsets), 0.0) / self.young_modulus

    @cached_property
    def struct(self) -> Any:
        """Struct fingerfem_segment for compiled code.

        Raises:
            ModelError: a segment beyond what compiled code holds.
        """
        return compiled.struct(self.condensed)

    @property
    def condensed(self) -> compiled.CondensedSegment:
        """Parts for compiled code: elements by pose, their variants, and shortenings of the tendons."""
        poses = {id(one): _pose_of(one) for one in self.elements}
        shortenings = {id(one): _values(one, [POSE + k for k in self.trained]) for one in self.elements}
        return compiled.CondensedSegment(
            elements=[poses[id(one)] for one in self.elements],
            half_lengths=self.half_lengths,
            section=self.section,
            depths=None if self.section.is_rectangle else self.depths,
            begins=self.begins,
            moduli=self.moduli,
            outlines=self.outlines,
            shortenings=[shortenings[id(one)] for one in self.elements],
            young_modulus=self.young_modulus,
            poisson=self.poisson,
            ridges=self.ridges,
            bulges=self.bulges,
        )

    def place(self, inputs: ArrayLike) -> tuple[np.ndarray, np.ndarray, np.ndarray, bool]:
        """The plate at tensions and the wrench on it, shape (t + 6,) [N, N m], seen from the clamp.

        Beyond their box elements go on linearly by their wrench, and stay by the tensions.

        Returns:
            centre, shape (3,) [m]; rotation, shape (3, 3) [-]; motion R^T dc, R^T dtheta by the inputs, shape
            (6, t + 6) [m, rad]; and whether the inputs of all elements lie in their boxes.

        Raises:
            ModelError: the wrong number of inputs.
        """
        given = np.asarray(inputs, float)
        if given.shape != (self.tensions + 6,):
            raise ModelError(f"inputs must be {', '.join(self.names)} and a wrench, got shape {given.shape}")
        return compiled.place(self.struct, given)


def segment_of(elements: Elements, pieces: Sequence[Piece], names: Sequence[str], trained: Sequence[int]) -> Segment:
    """The segment of some elements.

    Args:
        elements: at their size and modulus.
        pieces: kinds and lengths, from the plate to the clamp.
        names: of the tensions that pass the segment.
        trained: which of the elements' tendons each of these is.
    """
    scales = {(one.size, one.modulus) for one in pieces}
    by_scale = {one: elements if one == (1, 1) else elements.scaled(*one) for one in scales}
    scaled = {one: by_scale[one.size, one.modulus] for one in pieces}
    geometry = elements.scene["geometry"]
    laws = {one: own.laws[one.kind].of_length(one.length) for one, own in scaled.items()}
    if any(one.ends[0] != one.ends[1] for one in pieces):
        shear, guided = shear_by_bending(elements.laws[INTERIOR]), _guided(elements.scene, elements.tensions)
        laws = {one: tapered(law, one, shear, guided) for one, law in laws.items()}
    laws = {one: with_transitions(law, one, scaled[one].laws).only(trained) for one, law in laws.items()}
    end, begin = pieces[0].ends[0], pieces[-1].ends[1]
    section, rubber = elements.section.scaled(end), elements.scene.get("rubber")
    half = np.array([elements.size * end * geometry["plate"] / 2, *section.box])
    outlines = {}
    for k, one in enumerate(pieces):
        if one not in outlines:
            outlines[one] = compiled.outline_of(scaled[one].outlines[one.kind], one, 0.0 if k else half[0])
    if len(scales) > 1:
        _in_one_box(laws, outlines)
    length = sum(one.length for one in pieces)
    return Segment(
        elements=[laws[one] for one in pieces],
        outlines=[outlines[one] for one in pieces],
        names=names,
        trained=trained,
        offsets=elements.size * end * np.array([_offset(elements.scene["tendons"], k) for k in trained]).reshape(-1, 2),
        half_lengths=half,
        section=section,
        area=area(elements.scene) * (elements.size * end) ** 2,
        begins=begin / end,
        length=length,
        moduli=[one.modulus for one in pieces],
        bulges=bulges_of([laws[one] for one in pieces], elements.scene, elements.size, trained, length)
        if elements.scene.get("chambers")
        else None,
        rubber=None if rubber is None else (elements.modulus * rubber["E"], rubber["nu"]),
    )


def _in_one_box(laws: dict[Piece, ElementMap], outlines: dict[Piece, compiled.Outline]) -> None:
    """Give elements of several sizes or moduli the tensions that all of them were trained with, in place."""
    every = list(laws.values())
    tensions = np.array(
        [np.max([one.tensions[0] for one in every], axis=0), np.min([one.tensions[1] for one in every], axis=0)]
    )
    combinations = len(every[0].tension_map)
    lower = np.max([one.polynomial.lower[:combinations] for one in every], axis=0)
    upper = np.min([one.polynomial.upper[:combinations] for one in every], axis=0)
    for piece, one in laws.items():
        laws[piece] = one.on(tensions, lower, upper)
        own = outlines[piece]
        outlines[piece] = replace(own, polynomial=on_tensions(own.polynomial, lower, upper))


def _guided(scene: dict[str, Any], loads: int) -> np.ndarray:
    """1 of tendons in channels, 0 of other loads, shape (loads,)."""
    guided = np.zeros(loads)
    guided[: len(scene["tendons"])] = [one.get("path", "channel") == "channel" for one in scene["tendons"]]
    return guided


def _offset(tendons: Sequence[dict[str, Any]], k: int) -> list[float]:
    """Offset of load k's channel [m]; 0 for a straight tendon and for a chamber, which come after the tendons."""
    has_channel = k < len(tendons) and tendons[k].get("path", "channel") == "channel"
    return tendons[k]["offset"] if has_channel else [0.0, 0.0]


def _pose_of(element: ElementMap) -> ElementMap:
    """An element without the shortenings of its tendons."""
    return replace(element, polynomial=_values(element, range(POSE)))


def _values(element: ElementMap, columns: Sequence[int]) -> Polynomial:
    """The polynomial of some of an element's values."""
    polynomial = element.polynomial
    return replace(polynomial, coefficients=polynomial.coefficients[:, list(columns)])
