"""A finger in tables for people."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rom.console.table import NOT_MEASURED, Table, accuracy, parameters, percent
from rom.dataset.grid import SHARE
from rom.rod.tables.calibration_tables import calibration_tables
from rom.rod.tables.free_domain import outside_without_contact
from rom.rod.weight import weight_of

if TYPE_CHECKING:
    from rom.rod.rod import Rod


def tables(rod: Rod) -> list[Table | str]:
    """Tables for people: a finger's segments, tendons, and its elements' errors of left-out lines."""
    left_out = rod.elements.provenance["left_out"]
    rows = [
        [str(k + 1), f"{1e3 * length:g}", ", ".join(map(str, reversed(own)))]
        for k, (length, own) in enumerate(zip(rod.scene["geometry"]["segments"], rod.pieces, strict=True))
    ]
    force, free = left_out["contact_force"], left_out["free_place_m"]
    measured, outside = accuracy(rod.accuracy), outside_without_contact(rod)
    finer = ", on a finer mesh than that of the training" if "corrected_by" in rod.elements.provenance else ""
    return [
        f"{rod.scene['name']}: a rod of {sum(map(len, rod.pieces))} elements, "
        f"trained on {rod.elements.scene['name']}"
        + "".join(
            f", {name} x {factor:g}"
            for name, factor in zip(("size", "modulus"), rod.similarity[:2], strict=True)
            if abs(factor - 1) > SHARE
        ),
        Table(header=["segment", "length [mm]", "elements from the clamp"], rows=rows),
        *_weight(rod),
        parameters(rod.parameters),
        *([outside] if outside else []),
        f"lines left out{finer}: contact force within {percent(force['p95'])} (95 %), "
        f"median {percent(force['median'])}; free tip within {1e6 * free['p95']:.3g} µm",
        *(measured if measured else [NOT_MEASURED]),
        *calibration_tables(rod.calibration),
    ]


def _weight(rod: Rod) -> list[str]:
    """Line with mass and acceleration of a finger that weighs, or no line."""
    weight = weight_of(rod)
    if weight is None:
        return []
    pull = ", ".join(f"{part:.3g}" for part in weight.gravity)
    return [f"mass {1e3 * weight.masses.sum():.3g} g, acceleration ({pull}) m/s^2"]
