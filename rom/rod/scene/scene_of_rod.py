"""Fit of elements to the finger of a scene: the size and modulus that scale them, and the tendons of each.

By similarity, a finger `size` times as large of rubber `modulus` times as stiff does the same under forces
modulus * size^2 times as large, at equal ratios of all lengths and of all moduli: exactly.
"""

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from rom.brief import brief
from rom.dataset.actuators import actuators_of
from rom.dataset.geometry import sizes_of
from rom.dataset.sections.section import channel_width, extent
from rom.files.checked_file import ModelError
from rom.files.file_kinds import uses_of
from rom.native import LIBRARY
from rom.rod.scene.chambers_of_rod import chambers_of, matched, rescaled_chamber, segment_with
from rom.rod.scene.intervals_of_rod import Interval, intervals_of
from rom.rod.scene.materials_of_rod import match_materials, materials_of, modulus_of, rescaled_law, rescaled_material
from rom.rod.scene.section_of_rod import NEAR, equal, rescaled_section, size_of_section, with_digest, without_square
from rom.rod.weight import gravity_of

MOST_SEGMENTS, MOST_ACTUATORS = 8, LIBRARY.constants.FINGERFEM_MOST_TENSIONS


@brief
class Similarity(NamedTuple):
    """By how much elements are scaled [-], and which of their tendons and chambers every one of the finger is.

    `intervals` are parts of the axis of other materials.
    """

    size: float
    modulus: float
    tendons: list[int]
    chambers: list[int]
    intervals: list[Interval]


def passing(
    trained: Mapping[str, Any], scene: Mapping[str, Any], found: Similarity, segment: int
) -> tuple[list[str], list[int]]:
    """The loads of a segment, counted from 0: their names, and which of the elements' loads they are.

    A tendon passes all segments up to its plate. A chamber is in one segment.
    """
    pairs = [
        (tendon["name"], which)
        for tendon, which in zip(scene["tendons"], found.tendons, strict=True)
        if tendon["segment"] > segment
    ]
    tendons = len(trained["tendons"])
    pairs += [
        (chamber["name"], tendons + which)
        for chamber, which in zip(scene.get("chambers") or [], found.chambers, strict=True)
        if segment_with(scene, chamber) == segment
    ]
    return [name for name, _ in pairs], [which for _, which in pairs]


def read_scene(path: str | Path) -> dict[str, Any]:
    """The tables of a scene's file that a rod needs.

    Raises:
        ModelError: no file, no TOML, or a table is missing.
    """
    try:
        with Path(path).open("rb") as stream:
            scene = tomllib.load(stream)
    except (OSError, tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ModelError(f"{path}: must be a scene in TOML, got {error}{uses_of(path)}") from None
    try:
        return of_tables(with_digest(scene, Path(path).parent))
    except ModelError as error:
        raise ModelError(f"{path}: {error}") from None


def of_tables(scene: Mapping[str, Any]) -> dict[str, Any]:
    """The tables of a scene that a rod needs, with what they leave out.

    Raises:
        ModelError: a table is missing or is no table of a scene.
    """
    for name, kind in (("geometry", dict), ("material", dict), ("tendons", list)):
        if not isinstance(scene.get(name), kind):
            raise ModelError(f"{name} must be given, got {scene.get(name)}")
    scene = without_square(scene)
    try:
        tables: dict[str, Any] = {
            "name": str(scene.get("name", "finger")),
            "geometry": _geometry(scene["geometry"], has_side=scene.get("section") is None),
            "material": dict(scene["material"]),
            "tendons": [_tendon(one) for one in scene["tendons"]],
        }
        tables |= {} if scene.get("section") is None else {"section": scene["section"]}
        tables |= {"chambers": chambers_of(scene)} if scene.get("chambers") else {}
        tables |= {"materials": materials_of(scene)} if scene.get("materials") else {}
        weight = {} if scene.get("gravity") is None else {"gravity": gravity_of(scene["gravity"], scene.get("density"))}
        return tables | weight
    except ModelError:
        raise
    except KeyError as error:
        raise ModelError(f"{error.args[0]} is required in a table of the scene, and missing") from None
    except (TypeError, ValueError) as error:
        raise ModelError(
            f"scene must have geometry, tendons and chambers as docs/reference/scene.md says, got {error!r}"
        ) from None


def completed(tables: dict[str, Any], trained: Mapping[str, Any]) -> dict[str, Any]:
    """A finger's tables, with those that it lacks from the scene of its elements."""
    own = {name: table for name, table in trained.items() if name not in ("chambers", "materials", "section")}
    section = trained.get("section")
    if section and "digest" in section and section["digest"] == tables.get("section", {}).get("digest"):
        return own | tables | {"section": section}  # with the measurements of the file
    return own | tables


def _geometry(table: dict[str, Any], has_side: bool) -> dict[str, Any]:
    sizes = {name: float(table[name]) for name in ("side", "plate") if has_side or name != "side"}
    channel = table.get("channel")
    segments = [float(one) for one in table["segments"]]
    geometry = sizes | {"segments": segments, "channel": None if channel is None else float(channel)}
    for name, value in geometry.items():
        lengths: list[float] = [] if value is None else np.ravel(value).tolist()
        if not all(0 < one < np.inf for one in lengths):
            raise ModelError(f"geometry.{name} must be finite and above 0 m, got {value}")
    if table.get("taper") is None:
        return geometry
    taper = [float(one) for one in table["taper"]]
    if len(taper) != len(segments) or not all(0 < one < np.inf for one in taper):
        raise ModelError(f"geometry.taper must be one ratio above 0 per segment, got {taper}")
    return geometry | {"taper": taper}


def _tendon(table: dict[str, Any]) -> dict[str, Any]:
    return {
        "name": str(table["name"]),
        "path": str(table.get("path", "channel")),
        "offset": [float(part) for part in table["offset"]],
        "segment": int(table["segment"]),
        "tension": [float(end) for end in table["tension"]],
    }


def similarity(trained: Mapping[str, Any], scene: Mapping[str, Any]) -> Similarity:
    """By how much elements of a trained scene must be scaled for another.

    Raises:
        ModelError: another section, rubber or plate, or a tendon or chamber that is missing: one line with both values.
    """
    size = size_of_section(trained, scene)
    over = "geometry.side" if "side" in scene["geometry"] else "the section's extent"
    for name in ("plate", "channel"):
        own, other = (
            (channel_width(one) if name == "channel" else one["geometry"][name]) / extent(one)
            for one in (scene, trained)
        )
        equal(f"geometry.{name} over {over}", own, other)
    modulus = modulus_of(trained["material"], scene["material"])
    count = len(scene["geometry"]["segments"])
    if not 1 <= count <= MOST_SEGMENTS:
        raise ModelError(f"geometry.segments must be at least one and at most {MOST_SEGMENTS}, got {count}")
    names = [one.name for one in actuators_of(scene)]
    if len(set(names)) < len(names):
        raise ModelError(f"tendons and chambers must have names of their own, got {', '.join(names)}")
    if len(names) > MOST_ACTUATORS:
        raise ModelError(f"tendons and chambers must be at most {MOST_ACTUATORS} of a rod, got {len(names)}")
    match_materials(trained, scene, size, modulus)
    intervals, sizes = intervals_of(trained, scene, modulus), sizes_of(scene["geometry"])
    moduli = modulus * np.array([1.0, *(one.modulus for one in intervals)])
    tendons = [_tendon_of(trained["tendons"], one, size * sizes, moduli) for one in scene["tendons"]]
    last = max((one["segment"] for one in scene["tendons"]), default=0)
    if last < count:
        raise ModelError(f"tendons must pass all segments, one at least of segment {count}, got {last}")
    scaling = Similarity(size, modulus, tendons, matched(trained, scene, size, moduli), intervals)
    for segment in range(1, count + 1):
        own = size * sizes[segment - 1 : segment + 1]
        _check_sums(trained["tendons"], scene["tendons"], scaling, (segment, own, moduli))
    return scaling


def rescaled(scene: Mapping[str, Any], modulus: float, size: float) -> dict[str, Any]:
    """The scene of a finger with its modulus and all lengths multiplied by factors [-].

    Highest tensions and pressures fall where the trained ones do, and do not rise.

    Raises:
        ModelError: another size of a section that is read from a file.
    """

    def longer(value: Any) -> Any:
        return None if value is None else (size * np.asarray(value, float)).tolist()

    lengths = {name: longer(one) for name, one in scene["geometry"].items() if name != "taper"}
    force = modulus * size**2
    tendons = [
        one
        | {"offset": longer(one["offset"])}
        | {"tension": [one["tension"][0] * force, one["tension"][1] * min(force, 1.0)]}
        for one in scene["tendons"]
    ]
    geometry = scene["geometry"] | lengths
    tables = dict(scene) | {"geometry": geometry, "tendons": tendons}
    tables["material"] = rescaled_law(scene["material"], modulus)
    if scene.get("section"):
        tables["section"] = rescaled_section(scene["section"], size)
    if scene.get("chambers"):
        tables["chambers"] = [rescaled_chamber(one, modulus, size) for one in scene["chambers"]]
    if scene.get("materials"):
        tables["materials"] = [rescaled_material(one, modulus, size) for one in scene["materials"]]
    return tables


def _trained(tension: list[float], moduli: np.ndarray, sizes: np.ndarray) -> tuple[float, float, float]:
    """Lowest and highest tension that all moduli and sizes were trained with [N], and how far off is equal."""
    lowest, highest = tension[0] * moduli.max() * sizes.max() ** 2, tension[1] * moduli.min() * sizes.min() ** 2
    return lowest, highest, NEAR * highest


def _check_sums(
    trained: list[dict[str, Any]],
    tendons: list[dict[str, Any]],
    found: Similarity,
    passed: tuple[int, np.ndarray, np.ndarray],
) -> None:
    """Tendons that pass a segment at one place pull there together; where none does, the tension is 0 N.

    `passed` is the segment, the sizes of its ends, and moduli [-].
    """
    segment, sizes, moduli = passed
    for k, one in enumerate(trained):
        own = [each for each, which in zip(tendons, found.tendons, strict=True) if which == k]
        passing = [each for each in own if each["segment"] >= segment]
        least, most = (sum(each["tension"][end] for each in passing) for end in (0, 1))
        lowest, highest, slack = _trained(one["tension"], moduli, sizes)
        if not (lowest - slack <= least and most <= highest + slack):
            names = " and ".join(each["name"] for each in passing) or "no tendon"
            offset = np.round(found.size * np.array(one["offset"]), 9).tolist()
            raise ModelError(
                f"tensions at offset {offset} in segment {segment} must lie in {lowest:.6g} to {highest:.6g} N, where "
                f"the elements were trained, got {least:.6g} to {most:.6g} N of {names}"
            )


def _tendon_of(trained: list[dict[str, Any]], one: dict[str, Any], sizes: np.ndarray, moduli: np.ndarray) -> int:
    """Which trained tendon a tendon is that passes sections of some sizes from the clamp on, shape (segments + 1,)."""
    name, size, segments = f"tendons.{one['name']}", sizes[0], len(sizes) - 1
    if not 1 <= one["segment"] <= segments:
        raise ModelError(f"{name}.segment must be from 1 to {segments}, got {one['segment']}")
    for k, other in enumerate(trained):
        apart = np.abs(np.array(one["offset"]) - size * np.array(other["offset"])).max()
        if apart <= NEAR * size * np.abs(other["offset"]).max() and one["path"] == other["path"]:
            lowest, highest, slack = _trained(other["tension"], moduli, sizes[: one["segment"] + 1])
            if not lowest - slack <= one["tension"][0] < one["tension"][1] <= highest + slack:
                raise ModelError(
                    f"{name}.tension must lie in {lowest:.6g} to {highest:.6g} N, where the elements were trained, "
                    f"got {one['tension']}"
                )
            return k
    known = ", ".join(str(np.round(size * np.array(other["offset"]), 9).tolist()) for other in trained)
    raise ModelError(
        f"{name}.offset must be that of a tendon of the elements, one of {known} m at the clamp, got {one['offset']}; "
        "train elements with this one"
    )
