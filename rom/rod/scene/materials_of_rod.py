"""Materials of a rod's scene: comparison of laws with those of the elements, and mass of a composite section."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from rom.brief import brief
from rom.dataset.geometry import is_all_along
from rom.dataset.sections.section import area, extent, mean_squares
from rom.files.checked_file import ModelError
from rom.rod.scene.section_of_rod import NEAR, equal

# Powers of a modulus by which constants of a law scale: 1 [Pa], -1 [1/Pa]; others have no unit.
MODULI = {"C1": 1, "C2": 1, "C3": 1, "C10": 1, "C01": 1, "mu": 1, "D1": -1, "E": 1}
DEFAULTS = {"yeoh": {"C2": 0.0, "C3": 0.0}}
PLAIN = ("nu", "alpha")  # constants without a unit
LIGHTEST, DENSEST = 10.0, 3e4  # of a rubber [kg/m^3]; lighter, it is meant in g/cm^3


@brief
class LineMass(NamedTuple):
    """The mass of a section of several materials, whose centre is on the axis.

    Attributes:
        density: mean over the section [kg/m^3].
        squares: means of y^2 and z^2 by mass, shape (2,) [m^2].
    """

    density: float
    squares: np.ndarray


def materials_of(scene: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the other materials of a scene as plain data.

    Those with `x` are of whole sections along a part of the axis, see `rom.rod.scene.intervals_of_rod`.

    Raises:
        ModelError: a part of the section along a part of the axis.
        KeyError, TypeError, ValueError: a key is missing, or is no number.
    """
    materials, geometry = [_checked(one) for one in scene.get("materials") or []], scene["geometry"]
    if len({one["name"] for one in materials}) < len(materials):
        raise ModelError(f"materials must differ in their names, got {[one['name'] for one in materials]}")
    for one in materials:
        x = one.pop("x", None)
        if is_all_along(geometry, x):
            continue
        begin, end = one["x"] = [float(part) for part in x]
        if not begin < end:
            raise ModelError(f"materials.{one['name']}.x must be [from, to] with from < to, got {one['x']}")
        if one["region"] != "section":
            raise ModelError(
                f"materials.{one['name']}.x must be left out of a rod's scene unless the region is 'section': elements "
                f"have one section, got {one['x']} of {one['region']!r}; use the full-order model "
                "(python3 -m fingerfem solve)"
            )
    return materials


def along(scene: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The other materials that extend all along the axis."""
    return [one for one in scene.get("materials") or [] if one.get("x") is None]


def _checked(given: Mapping[str, Any]) -> dict[str, Any]:
    """One of the materials, as plain data."""
    material = dict(given) | {"material": dict(given["material"])}
    for key in ("centre", "size") if material["region"] == "rectangle" else ():
        if np.shape(material[key]) != (2,) or not np.isfinite(np.array(material[key], float)).all():
            raise ModelError(f"materials.{material['name']}.{key} must be two finite numbers [m], got {material[key]}")
    density = material.get("density")
    if density is not None and not LIGHTEST <= density <= DENSEST:
        name = f"materials.{material['name']}.density"
        raise ModelError(f"{name} must be from {LIGHTEST:g} to {DENSEST:g} kg/m^3, got {density}")
    return material


def match_materials(trained: Mapping[str, Any], scene: Mapping[str, Any], size: float, modulus: float) -> None:
    """Refuse materials whose names, regions or stiffness ratios differ from those of the elements.

    Args:
        trained: the elements' scene.
        scene: of the finger.
        size: ratio of the finger's size to that of the elements [-].
        modulus: ratio of the rubber's moduli [-].

    Raises:
        ModelError: a difference, with both values.
    """
    own, others = ({one["name"]: one for one in along(table)} for table in (scene, trained))
    if own.keys() != others.keys():
        names = (", ".join(table) or "none" for table in (others, own))
        raise ModelError("materials must be those of the elements, {}, got {}".format(*names))
    for name, one in own.items():
        other = others[name]
        if one["region"] != other["region"]:
            raise ModelError(f"materials.{name}.region must be {other['region']!r}, got {one['region']!r}")
        for key in ("centre", "size") if one["region"] == "rectangle" else ():
            wanted = size * np.array(other[key])
            if np.abs(np.array(one[key]) - wanted).max() > NEAR * extent(scene):
                raise ModelError(f"materials.{name}.{key} must be {np.round(wanted, 9).tolist()} m, got {one[key]}")
        try:
            stiffer = modulus_of(other["material"], one["material"])
            equal("modulus over that of the elements", stiffer, modulus)
        except ModelError as error:
            raise ModelError(f"materials.{name}: {error}") from None
    if scene.get("gravity") is not None:
        line_mass(scene, scene["gravity"]["density"])


def line_mass(scene: Mapping[str, Any], rubber: float, material: str | None = None) -> LineMass:
    """Return the mass of a section, with the rubber's density [kg/m^3] and the scene's densities of other materials.

    A material of area A whose density exceeds that of the rubber by r adds r A. The section has the materials that
    extend all along the axis, or is of `material`.

    Raises:
        ModelError: the centre of mass is not on the axis.
    """
    whole = area(scene)
    mass, first, second = rubber * whole, np.zeros(2), rubber * whole * mean_squares(scene)
    own = [one for one in scene.get("materials") or [] if one["name"] == material] if material else along(scene)
    for one in own:
        share, centre, squares = _region(scene, one)
        heavier = ((one.get("density") or rubber) - rubber) * share
        mass, first, second = mass + heavier, first + heavier * centre, second + heavier * squares
    if np.abs(first).max() > NEAR * mass * extent(scene):
        raise ModelError(
            "materials must have a centre of mass on the axis, "
            f"got y = {first[0] / mass:.3g}, z = {first[1] / mass:.3g} m"
        )
    return LineMass(mass / whole, second / mass)


def _region(scene: Mapping[str, Any], one: Mapping[str, Any]) -> tuple[float, np.ndarray, np.ndarray]:
    """Area [m^2] of a material's region, its centroid [m], and means of y^2 and z^2 over it [m^2], shapes (2,)."""
    if one["region"] == "section":
        return area(scene), np.zeros(2), mean_squares(scene)
    if one["region"] == "group":
        measured = scene["section"]["measures"]["materials"][one["name"]]
        return measured["area"], np.array(measured["centroid"]), np.array(measured["mean_squares"])
    centre, size = np.array(one["centre"], float), np.array(one["size"], float)
    return float(size.prod()), centre, centre**2 + size**2 / 12


def rescaled_material(one: Mapping[str, Any], modulus: float, size: float) -> dict[str, Any]:
    """A material of a finger with its moduli and all lengths multiplied by factors [-], see `scene_of_rod.rescaled`."""
    lengths = {key: (size * np.array(one[key])).tolist() for key in ("centre", "size", "x") if one.get(key) is not None}
    return dict(one) | lengths | {"material": rescaled_law(one["material"], modulus)}


def rescaled_law(material: Mapping[str, Any], modulus: float) -> dict[str, Any]:
    """A law whose moduli are multiplied by a factor [-]."""
    return {
        name: (modulus ** MODULI[name] * np.asarray(one, float)).tolist() if name in MODULI else one
        for name, one in material.items()
    }


def modulus_of(trained: Mapping[str, Any], material: Mapping[str, Any]) -> float:
    """Return the ratio of a material's moduli to those of the elements [-].

    Raises:
        ModelError: another law, or other ratios of its constants, with both values.
    """
    law, other = (one.get("law", "neo-hookean") for one in (material, trained))
    if law != other:
        raise ModelError(f"material.law must be {other}, the elements' own, got {law}")
    constants = [name for name in trained if name in MODULI or name in PLAIN]
    material = DEFAULTS.get(law, {}) | dict(material)
    if missing := [name for name in constants if name not in material]:
        given = ", ".join(name for name in ("E", "nu", "shore_A") if name in material)
        also = f"; {given} are for the full-order model, the elements have {missing[0]} = {trained[missing[0]]}"
        raise ModelError(f"material.{missing[0]} must be given, got none{also if given else ''}")
    own, others = ({name: np.atleast_1d(one[name]) for name in constants} for one in (material, trained))
    for name in constants:
        if own[name].dtype.kind not in "if" or not np.isfinite(own[name]).all():
            raise ModelError(f"material.{name} must be a finite number, got {material[name]!r}")
        if own[name].shape != others[name].shape:
            raise ModelError(f"material.{name} must have {others[name].size} numbers, got {own[name].size}")
    first = next(name for name in constants if MODULI.get(name) == 1)
    modulus = float(own[first][0] / others[first][0])
    if not 0 < modulus < np.inf:
        raise ModelError(f"material.{first} must be above 0, got {material[first]}")
    for name in constants:
        for value, wanted in zip(own[name], others[name] * modulus ** MODULI.get(name, 0), strict=True):
            equal(f"material.{name} (with {first} = {own[first][0]:g})", value, wanted)
    return modulus
