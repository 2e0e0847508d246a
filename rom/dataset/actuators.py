"""The actuators of a finger, by its scene as plain data: tensions of tendons, then pressures of chambers."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from rom.files.checked_file import ModelError


class Actuator(NamedTuple):
    """One actuator's load: its name, its unit, N or Pa, and the ends of its range in that."""

    name: str
    unit: str
    lower: float
    upper: float


def actuators_of(scene: Mapping[str, Any]) -> list[Actuator]:
    """The actuators of a scene, in the order of its parameters."""
    ranges = [(one["name"], "N", one["tension"]) for one in scene["tendons"]]
    ranges += [(one["name"], "Pa", one["pressure"]) for one in scene.get("chambers") or []]
    return [Actuator(name, unit, float(lower), float(upper)) for name, unit, (lower, upper) in ranges]


def refuse_chambers(scene: Mapping[str, Any], what: str) -> None:
    """Raise ModelError where a finger has chambers, of something that is for tendons alone."""
    if count := pressures_of(scene):
        raise ModelError(f"{what} must be of a finger with tendons alone, got one with {count} chambers")


def pressures_of(scene: Mapping[str, Any]) -> int:
    """Number of chambers, whose pressures are the last of the loads."""
    return len(scene.get("chambers") or [])


def count_of(scene: Mapping[str, Any]) -> int:
    """Number of actuators."""
    return len(scene["tendons"]) + pressures_of(scene)
