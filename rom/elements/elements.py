"""The trained elements of a section, and their part of a model file."""

from __future__ import annotations

import json
from dataclasses import dataclass, field, replace
from typing import Any

import h5py
import numpy as np

from rom.brief import brief
from rom.dataset.actuators import count_of, pressures_of
from rom.dataset.sections.section_outline import SectionOutline
from rom.elements.law import ElementLaw
from rom.elements.outline import OutlineLaw
from rom.elements.polynomial import Polynomial
from rom.files import checked_file

CLAMP, INTERIOR, PLATE, WHOLE = "clamp", "interior", "plate", "whole"  # kinds of elements
SECTION = "section"  # the group of a file that holds the section's outline
UNCALIBRATED = 2.0  # times the variants' deviation: 95 % of a normal distribution [-]
UNITS = "place m, Rodrigues vector -, shortening m, growth m^3; of interior elements per m"


@brief
@dataclass(frozen=True, kw_only=True)
class Elements:
    """Elements of one section and rubber, with the tendons that pass them.

    Attributes:
        laws: by kind: `clamp`, from the clamp on, and `plate`, to the plate's centre, both of one length; `interior`,
            of any length between these. Or `whole` alone, from clamp to plate, of a finger too short for three.
        section: its outline at rest, around whose box the outlines' corners are.
        scene: that they were trained on, as plain data.
        outlines: by kind, where the corners of its cross-sections are.
        force: largest on a plate [N].
        provenance: what they were made from, and how well they predict what they were not made from.
        error_factors: by quantity, how many times the deviation of the laws' variants an estimated error is, so that it
            covers what was left out [-]; UNCALIBRATED of a quantity that is missing.
        size: times how large they are, of what the scene says [-].
        modulus: times how stiff their rubber is, likewise [-].
    """

    laws: dict[str, ElementLaw]
    outlines: dict[str, OutlineLaw]
    section: SectionOutline
    scene: dict[str, Any]
    force: float
    provenance: dict[str, Any]
    error_factors: dict[str, float] = field(default_factory=dict)
    size: float = 1.0
    modulus: float = 1.0

    @property
    def tensions(self) -> int:
        """Number of loads, tensions and then pressures."""
        return count_of(self.scene)

    def error_factor(self, quantity: str) -> float:
        """Ratio of a quantity's estimated error to the variants' deviation [-]."""
        return self.error_factors.get(quantity, UNCALIBRATED)

    def scaled(self, size: float, modulus: float) -> Elements:
        """The same section `size` times as large, of rubber `modulus` times as stiff."""
        laws = {kind: law.scaled(size, modulus) for kind, law in self.laws.items()}
        outlines = {kind: law.scaled(size, modulus) for kind, law in self.outlines.items()}
        force, section = self.force * modulus * size**2, self.section.scaled(size)
        elements = replace(self, laws=laws, outlines=outlines, section=section, force=force)
        return replace(elements, size=self.size * size, modulus=self.modulus * modulus)

    def write(self, file: h5py.Group) -> None:
        """Write them into an open file."""
        file.attrs["scene"], file.attrs["provenance"] = json.dumps(self.scene), json.dumps(self.provenance)
        file.attrs["force"], file.attrs["error_factors"] = self.force, json.dumps(self.error_factors)
        self.section.write(file.create_group(SECTION))
        for kind, law in self.laws.items():
            group, outline = file.create_group(kind), self.outlines[kind]
            group.attrs["lengths"] = law.lengths
            checked_file.dataset(group, "tension_map", law.tension_map, "-")
            checked_file.dataset(group, "tensions", law.tensions, "N, Pa")
            _write(group, law.polynomial, UNITS)
            if law.deviations is not None:
                _write(group.create_group("variants"), law.deviations, UNITS)
            group = group.create_group("outline")
            group.attrs["half"], group.attrs["error"] = outline.half, outline.error
            _write(group, outline.polynomial, "m")

    @classmethod
    def read(cls, file: h5py.Group) -> Elements:
        """The elements in an open file; one that names no section has a square, as files of earlier versions do."""
        laws, outlines = {}, {}
        scene, provenance = (json.loads(file.attrs[name]) for name in ("scene", "provenance"))
        for kind in file:
            if kind == SECTION:
                continue
            group, outline = file[kind], file[kind]["outline"]
            shortest, longest = map(float, group.attrs["lengths"])
            tension_map, tensions = (group[name][:].astype(float) for name in ("tension_map", "tensions"))
            laws[kind] = ElementLaw(
                tension_map=tension_map,
                tensions=tensions,
                polynomial=_read(group),
                lengths=(shortest, longest),
                deviations=_read(group["variants"]) if "variants" in group else None,
                pressures=pressures_of(scene),
            )
            outlines[kind] = OutlineLaw(
                tension_map=tension_map,
                tensions=tensions,
                polynomial=_read(outline),
                half=np.broadcast_to(outline.attrs["half"], 2).astype(float),
                error=float(outline.attrs["error"]),
                pressures=pressures_of(scene),
            )
        force, factors = float(file.attrs["force"]), json.loads(file.attrs["error_factors"])
        known = SECTION in file
        section = SectionOutline.read(file[SECTION]) if known else SectionOutline.rectangle(*outlines[kind].half)
        return cls(
            laws=laws,
            outlines=outlines,
            section=section,
            scene=scene,
            force=force,
            provenance=provenance,
            error_factors=factors,
        )


def _write(group: h5py.Group, polynomial: Polynomial, unit: str) -> None:
    checked_file.dataset(group, "box", np.array([polynomial.lower, polynomial.upper]), "N, N m, m")
    checked_file.dataset(group, "powers", polynomial.powers, "-")
    checked_file.dataset(group, "coefficients", polynomial.coefficients, unit)


def _read(group: h5py.Group) -> Polynomial:
    lower, upper = group["box"][:].astype(float)
    powers, coefficients = group["powers"][:].astype(int), group["coefficients"][:].astype(float)
    return Polynomial(lower=lower, upper=upper, powers=powers, coefficients=coefficients)
