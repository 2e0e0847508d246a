"""The errors a finger is expected to have: those of lines left out of the training, at its size and length."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rom.brief import brief
from rom.dataset.geometry import steepest
from rom.dataset.sections.section import extent
from rom.elements.elements import INTERIOR, Elements
from rom.elements.fitting.calibration import Floors, floors_of
from rom.elements.taper import shear_by_bending
from rom.rod.scene.materials_of_rod import along

if TYPE_CHECKING:
    from rom.rod.rod import Rod


class Added(NamedTuple):
    """Additions by changes along the axis to errors of contact forces [-], positions [m], turns [rad], shortenings [m].

    In constants, the lengths are over that of the finger.
    """

    contact_force: float
    position: float
    turn: float
    shortening: float


NOTHING = Added(0.0, 0.0, 0.0, 0.0)
TAPER = Added(0.05, 7e-3, 0.03, 4e-3)  # over the steepest change of the side per length, to 1:2 (docs/accuracy.md)
# Over the sum of s (1 - s) of all transitions between materials, with the share s of `rom.elements.transition`: none
# where a neighbour is as stiff, or rigid. Measured at moduli of 0.5 to 100, and Poisson's ratios of 0.3 and 0.41.
TRANSITION = Added(0.02, 6e-3, 0.01, 2e-3)
SOLID = (
    0.29  # shear compliance times bending stiffness of solid sections of rubber, over the extent's square, at most [-]
)
AXES = 3  # along each of which the floor of a place acts


@brief
@dataclass(frozen=True, kw_only=True)
class ExpectedErrors:
    """95th percentiles of errors in lines that were left out of the training.

    An error of a turn acts with the distance to the tip as its lever: a finger longer than the trained one has larger
    errors, the turn's by the ratio of the lengths, the position's by its square.

    Attributes:
        contact_force: relative [-].
        position: of the free tip plate [m].
        turn: of the tip plate's orientation [rad].
        shortening: of tendons [m].
        growth: of chambers [m^3].
        surface: of the rubber's surface, that of its outlines and of the sections' positions [m].
        floors: what estimated errors are not below.
    """

    contact_force: float
    position: float
    turn: float
    shortening: float
    growth: float
    surface: float
    floors: Floors

    def at_least(self, measured: Mapping[str, float], elements: Elements) -> ExpectedErrors:
        """The same, nowhere below errors that a calibration measured, nor are the estimates of answers.

        Args:
            measured: 95th percentiles, by the names of these attributes; what is absent was not measured.
            elements: as they were trained.
        """
        if not measured:
            return self
        own = {name: max(getattr(self, name), float(value)) for name, value in measured.items()}
        place = float(measured.get("position", 0.0)) / (AXES**0.5 * elements.error_factor("tip"))
        force = float(measured.get("contact_force", 0.0)) / elements.error_factor("contact_force")
        floors = Floors(max(self.floors.place, place), max(self.floors.force, force))
        return replace(self, **own, floors=floors)


def expected_errors(
    elements: Elements, kinds: Iterable[str], size: float, longer: float, added: Added = NOTHING
) -> ExpectedErrors:
    """Expected errors of a finger.

    Args:
        elements: as they were trained.
        kinds: of the finger's elements.
        size: the finger's over the trained one's [-].
        longer: the finger's length over the trained one's at this size [-].
        added: by changes along the axis.
    """
    left_out = elements.provenance["left_out"]
    longer = max(longer, 1.0)
    lever = size * longer**2
    place, force = floors_of(left_out)
    position = float(left_out["free_place_m"]["p95"]) * lever + added.position
    return ExpectedErrors(
        contact_force=float(left_out["contact_force"]["p95"]) + added.contact_force,
        position=position,
        turn=float(left_out["turn_rad"]["p95"]) * longer + added.turn,
        shortening=float(left_out["shortening_m"]["p95"]) * size * longer + added.shortening,
        growth=float(left_out.get("growth_m3", {"p95": 0.0})["p95"]) * size**3 * longer,
        surface=max(size * elements.outlines[kind].error for kind in kinds) + position,
        floors=Floors(place * lever + added.position, force + added.contact_force),
    )


def errors_of(rod: Rod) -> ExpectedErrors:
    """Expected errors of a finger; at least those on the log of its calibration."""
    trained, geometry = sum(rod.elements.scene["geometry"]["segments"]), rod.scene["geometry"]
    thinner = [sum(one.length / one.size for one in own) / sum(one.length for one in own) for own in rod.pieces]
    longer = float(np.dot(thinner, geometry["segments"]) / (rod.similarity.size * trained))
    kinds = {piece.kind for own in rod.pieces for piece in own}
    errors = expected_errors(rod.elements, kinds, rod.similarity.size, longer, _added(rod))
    return errors.at_least(rod.calibration.get("errors", {}), rod.elements)


def _added(rod: Rod) -> Added:
    """By the taper of a finger, and by transitions between its materials."""
    geometry, length = rod.scene["geometry"], sum(rod.scene["geometry"]["segments"])
    slope = steepest(geometry, extent(rod.scene))
    transitions = sum(share * (1 - share) for own in rod.pieces for piece in own for share in piece.hindered)
    if slope and along(rod.scene):
        # a stiff layer yields by shear, by which a taper's corrections of first order are less exact
        shear = shear_by_bending(rod.own.laws[INTERIOR]).max() / extent(rod.scene) ** 2
        slope *= max(shear / SOLID, 1.0)
    sums = slope * np.array(TAPER) + transitions * np.array(TRANSITION)
    return Added(*(sums * [1.0, length, 1.0, length]).tolist())
