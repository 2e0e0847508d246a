"""The trained elements of a section, and their part of a model file."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import Any

import h5py
import numpy as np

from rom import checked_file
from rom.brief import brief
from rom.elements.law import ElementLaw
from rom.fit.chebyshev import Polynomial

CLAMP, INTERIOR, PLATE, WHOLE = "clamp", "interior", "plate", "whole"  # kinds of elements
UNITS = "place m, Rodrigues vector -, shortening m; of interior elements per m"


@brief
@dataclass(frozen=True, kw_only=True)
class Elements:
    """Elements of one section and rubber, with the tendons that pass them.

    Attributes:
        laws: by kind: `clamp`, from the clamp on, and `plate`, to the plate's centre, both of one length; `interior`,
            of any length between these. Or `whole` alone, from clamp to plate, of a finger too short for three.
        scene: that they were trained on, as plain data.
        force: largest on a plate [N].
        provenance: what they were made from, and how well they predict what they were not made from.
    """

    laws: dict[str, ElementLaw]
    scene: dict[str, Any]
    force: float
    provenance: dict[str, Any]

    @property
    def tensions(self) -> int:
        """Number of tensions."""
        return len(self.scene["tendons"])

    def scaled(self, size: float, modulus: float) -> Elements:
        """The same section `size` times as large, of rubber `modulus` times as stiff."""
        laws = {kind: law.scaled(size, modulus) for kind, law in self.laws.items()}
        return replace(self, laws=laws, force=self.force * modulus * size**2)

    def write(self, file: h5py.Group) -> None:
        """Write them into an open file."""
        file.attrs["scene"], file.attrs["provenance"] = json.dumps(self.scene), json.dumps(self.provenance)
        file.attrs["force"] = self.force
        for kind, law in self.laws.items():
            group, polynomial = file.create_group(kind), law.polynomial
            group.attrs["lengths"] = law.lengths
            checked_file.dataset(group, "tension_map", law.tension_map, "-")
            checked_file.dataset(group, "tensions", law.tensions, "N")
            checked_file.dataset(group, "box", np.array([polynomial.lower, polynomial.upper]), "N, N m, m")
            checked_file.dataset(group, "powers", polynomial.powers, "-")
            checked_file.dataset(group, "coefficients", polynomial.coefficients, UNITS)

    @classmethod
    def read(cls, file: h5py.Group) -> Elements:
        """The elements in an open file."""
        laws = {}
        for kind in file:
            group = file[kind]
            lower, upper = group["box"][:].astype(float)
            polynomial = Polynomial(
                lower=lower,
                upper=upper,
                powers=group["powers"][:].astype(int),
                coefficients=group["coefficients"][:].astype(float),
            )
            shortest, longest = map(float, group.attrs["lengths"])
            laws[kind] = ElementLaw(
                tension_map=group["tension_map"][:].astype(float),
                tensions=group["tensions"][:].astype(float),
                polynomial=polynomial,
                lengths=(shortest, longest),
            )
        scene, provenance = (json.loads(file.attrs[name]) for name in ("scene", "provenance"))
        return cls(laws=laws, scene=scene, force=float(file.attrs["force"]), provenance=provenance)
