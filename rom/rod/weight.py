"""The weight of a finger: what its scene says, and the masses of its plates and elements."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rom.brief import brief
from rom.dataset.geometry import rubber_of
from rom.dataset.sections.section import area
from rom.files.checked_file import ModelError
from rom.rod.scene.materials_of_rod import DENSEST, LIGHTEST, line_mass

if TYPE_CHECKING:
    from rom.rod.rod import Rod

STEEL, STANDARD = 7850.0, 9.80665  # density [kg/m^3] and acceleration [m/s^2] that a scene may leave out
LARGEST = 1e4  # [m/s^2]
SHORTEST = 1e-6  # least length of a direction [-]


@brief
class Weight(NamedTuple):
    """Masses of a finger by rows: of every segment its plate, then its elements from the plate to the clamp.

    Attributes:
        gravity: acceleration seen from the clamp, shape (3,) [m/s^2].
        masses: shape (rows,) [kg].
        rubber: lengths of rubber at rest, 0 for a plate, shape (rows,) [m].
    """

    gravity: np.ndarray
    masses: np.ndarray
    rubber: np.ndarray


def gravity_of(table: Mapping[str, Any], density: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """The table [gravity] of a scene, with what it leaves out, and with the densities of [density] if there is one.

    Raises:
        ModelError: a key is missing, unknown or out of its range: one line with its value.
    """
    if not isinstance(table, Mapping):
        raise ModelError(f"gravity must be a table [gravity], got {table!r}")
    if density is not None:
        own = {name: value for name, value in table.items() if name not in ("density", "plate_density")}
        table = own | {"density": density.get("rubber"), "plate_density": density.get("plates", STEEL)}
    known = {"density", "plate_density", "direction", "acceleration"}
    if missing := [name for name in ("density", "direction") if name not in table]:
        raise ModelError(f"gravity.{missing[0]} must be given, got none")
    if unknown := sorted(set(table) - known):
        raise ModelError(f"gravity must have the keys {', '.join(sorted(known))}, got {unknown[0]}")
    gravity: dict[str, Any] = {"plate_density": STEEL, "acceleration": STANDARD} | dict(table)
    for name, most in (("density", DENSEST), ("plate_density", DENSEST), ("acceleration", LARGEST)):
        gravity[name] = value = _number(name, gravity[name])
        least = LIGHTEST if name == "density" else 0.0
        if not least <= value <= most:
            raise ModelError(f"gravity.{name} must be from {least:g} to {most:g}, got {value:g}")
    return gravity | {"direction": _direction(table["direction"])}


def _number(name: str, given: Any) -> float:
    if type(given) not in (int, float):
        raise ModelError(f"gravity.{name} must be a number, got {given!r}")
    return float(given)


def _direction(given: Any) -> list[float]:
    parts = given if isinstance(given, (list, tuple)) else [given]
    direction = [_number("direction", part) for part in parts]
    if len(direction) != 3 or not SHORTEST < np.abs(direction).max() < 1 / SHORTEST:
        raise ModelError(
            f"gravity.direction must be three numbers, the largest from {SHORTEST:g} to {1 / SHORTEST:g}, got {given}"
        )
    return direction


def weight_of(rod: Rod) -> Weight | None:
    """The weight of a finger; None if its scene has no [gravity]."""
    table = rod.scene.get("gravity")
    if table is None:
        return None
    whole, masses, rubber = area(rod.scene), list[float](), list[float]()
    begins = rubber_of(rod.scene["geometry"])[:, 0].tolist()
    for segment, own, begin in zip(rod.segments, rod.pieces, begins, strict=True):
        plate = 2 * float(segment.half_lengths[0]) * segment.area
        lengths = np.array([piece.length for piece in own])
        lengths[0] -= segment.half_lengths[0]  # its distal section is the plate's centre
        areas = np.array([whole * sum(a * b for a, b in _pairs(piece.ends)) / 3 for piece in own])
        rest = lengths * areas - _voids(rod.scene, lengths, begin)
        densities = [line_mass(rod.scene, table["density"], piece.material).density for piece in own]
        masses += [table["plate_density"] * plate, *(densities * rest).tolist()]
        rubber += [0.0, *lengths.tolist()]
    direction = np.array(table["direction"])
    gravity = table["acceleration"] * direction / np.linalg.norm(direction)
    return Weight(gravity, np.array(masses), np.array(rubber))


def _voids(scene: Mapping[str, Any], lengths: np.ndarray, begin: float) -> np.ndarray:
    """Volumes of chambers in elements, from the plate to a clamp at `begin` [m], shape (elements,) [m^3]."""
    volumes, begins = np.zeros(len(lengths)), begin + np.cumsum(lengths[::-1])[::-1] - lengths
    for one in scene.get("chambers") or []:
        overlap = np.minimum(begins + lengths, one["x"][1]) - np.maximum(begins, one["x"][0])
        volumes += np.prod(one["size"]) * np.maximum(overlap, 0.0)
    return volumes


def _pairs(ends: tuple[float, float]) -> list[tuple[float, float]]:
    """Products whose sum is three times the mean square of a size that changes linearly between both."""
    a, b = ends
    return [(a, a), (a, b), (b, b)]


def turned(scene: Mapping[str, Any], direction: Any, acceleration: float | None = None) -> dict[str, Any]:
    """A scene whose weight pulls in another direction.

    Raises:
        ModelError: the scene has no [gravity], or the direction is none.
    """
    table = scene.get("gravity")
    if table is None:
        raise ModelError("gravity must be in the finger's scene, with a density, for its direction to change; got none")
    change = {"direction": np.asarray(direction, float).tolist()} | (
        {} if acceleration is None else {"acceleration": acceleration}
    )
    return dict(scene) | {"gravity": gravity_of(table | change)}
