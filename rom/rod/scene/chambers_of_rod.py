"""The chambers of a rod's scene: read, and compared with those of its elements."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from rom.dataset.geometry import rubber_of
from rom.dataset.sections.section import extent
from rom.files.checked_file import ModelError
from rom.rod.scene.section_of_rod import NEAR


def chambers_of(scene: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The chambers of a scene, as plain data.

    Raises:
        ModelError: one is no rectangle, the rubber around it has a taper, or its weight is off the axis.
        KeyError, TypeError, ValueError: a key is missing, or is no number.
    """
    chambers = list[dict[str, Any]]()
    for one in scene.get("chambers") or []:
        if one["region"] != "rectangle":
            raise ModelError(
                f"chambers.{one['name']}.region must be 'rectangle' in a rod's scene, got {one['region']!r}"
            )
        numbers = {key: [float(part) for part in one[key]] for key in ("centre", "size", "x", "pressure")}
        chambers.append({"name": str(one["name"]), "region": "rectangle"} | numbers)
    first = np.sum([np.prod(one["size"]) * np.array(one["centre"]) for one in chambers], axis=0)
    if chambers and scene.get("gravity") is not None and np.abs(first).max() > NEAR * extent(scene) ** 3:
        raise ModelError(
            "gravity must be left out with chambers on one side: a rod's weight acts on its axis, got chambers "
            f"{', '.join(one['name'] for one in chambers)}"
        )
    if chambers and any(ratio != 1 for ratio in scene["geometry"].get("taper") or []):
        raise ModelError(f"geometry.taper must be left out with chambers, got {scene['geometry']['taper']}")
    return chambers


def matched(trained: Mapping[str, Any], scene: Mapping[str, Any], size: float, moduli: np.ndarray) -> list[int]:
    """Which chamber of the elements every chamber of a finger is.

    A chamber ends as far from its segment's clamp and plate as that of the elements does. Every segment has each of the
    elements' chambers, whose voids it has.

    Args:
        trained: the elements' scene.
        scene: of the finger.
        size: of the finger over the elements' [-].
        moduli: likewise of its materials [-].

    Raises:
        ModelError: one line with both values.
    """
    own, others = scene.get("chambers") or [], trained.get("chambers") or []
    if not own and not others:
        return []
    numbers = [_matching(trained, scene, one, size, moduli) for one in own]
    for k in range(len(scene["geometry"]["segments"])):
        here = [(one, which) for one, which in zip(own, numbers, strict=True) if segment_with(scene, one) == k]
        if sorted(which for _, which in here) != list(range(len(others))):
            names = ", ".join(one["name"] for one, _ in here) or "none"
            raise ModelError(
                f"chambers in segment {k + 1} must be those of the elements, each once ({len(others)} of them), "
                f"got {names}"
            )
    return numbers


def segment_with(scene: Mapping[str, Any], chamber: Mapping[str, Any]) -> int:
    """The segment, counted from 0, whose rubber contains a chamber.

    Raises:
        ModelError: it lies in no segment's rubber.
    """
    rubber, near = rubber_of(scene["geometry"]), NEAR * extent(scene)
    begin, end = chamber["x"]
    inside = np.flatnonzero((rubber[:, 0] - near <= begin) & (end <= rubber[:, 1] + near))
    if not inside.size:
        spans = " or ".join(str(np.round(one, 9).tolist()) for one in rubber)
        raise ModelError(
            f"chambers.{chamber['name']}.x must lie in the rubber of one segment, {spans} m, got {chamber['x']}"
        )
    return int(inside[0])


def _matching(
    trained: Mapping[str, Any], scene: Mapping[str, Any], one: Mapping[str, Any], size: float, moduli: np.ndarray
) -> int:
    """The elements' chamber at a chamber's place, if that is like it."""
    name, ends = f"chambers.{one['name']}", _ends(scene, one)
    near = NEAR * extent(scene)
    for k, other in enumerate(trained.get("chambers") or []):
        if np.abs(np.subtract(one["centre"], size * np.array(other["centre"]))).max() > near:
            continue
        for what, value, wanted in (
            ("size", np.array(one["size"]), size * np.array(other["size"])),
            ("x, distances from the segment's clamp and plate,", ends, size * _ends(trained, other)),
        ):
            if np.abs(value - wanted).max() > near:
                raise ModelError(f"{name}.{what} must be {np.round(wanted, 9).tolist()} m, got {value.tolist()}")
        lowest, highest = other["pressure"][0] * moduli.max(), other["pressure"][1] * moduli.min()
        slack = NEAR * highest
        if not lowest - slack <= one["pressure"][0] < one["pressure"][1] <= highest + slack:
            raise ModelError(
                f"{name}.pressure must lie in {lowest:.6g} to {highest:.6g} Pa, where the elements were trained, "
                f"got {one['pressure']}"
            )
        return k
    known = [np.round(size * np.array(other["centre"]), 9).tolist() for other in trained.get("chambers") or []]
    raise ModelError(
        f"{name}.centre must be that of a chamber of the elements, one of {known or 'none'} m, got {one['centre']}"
    )


def rescaled_chamber(one: Mapping[str, Any], modulus: float, size: float) -> dict[str, Any]:
    """A chamber of a finger with its modulus and all lengths multiplied by factors [-], see `scene_of_rod.rescaled`."""
    lowest, highest = one["pressure"]
    lengths = {key: (size * np.array(one[key])).tolist() for key in ("centre", "size", "x")}
    return dict(one) | lengths | {"pressure": [lowest * modulus, highest * min(modulus, 1.0)]}


def _ends(scene: Mapping[str, Any], chamber: Mapping[str, Any]) -> np.ndarray:
    """Distances of a chamber's ends from its segment's clamp and plate, shape (2,) [m]."""
    begin, end = rubber_of(scene["geometry"])[segment_with(scene, chamber)]
    return np.array([chamber["x"][0] - begin, end - chamber["x"][1]])
