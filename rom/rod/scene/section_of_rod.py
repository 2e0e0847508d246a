"""The section of a rod's scene: its table, and its size over that of the elements' section."""

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from rom.dataset.sections.section import FILE, RECTANGLE, RING, SIZES, SQUARE, section_of
from rom.files.checked_file import ModelError

NEAR = 1e-6  # relative difference of two numbers that are meant to be equal [-]
WRITTEN = ("digest", "measures")  # keys that the full-order model writes besides a file's path


def with_digest(scene: dict[str, Any], folder: Path) -> dict[str, Any]:
    """A scene whose section names the content of its file, which is seen from a folder.

    Raises:
        ModelError: the file cannot be read.
    """
    section = scene.get("section")
    if not isinstance(section, dict) or not isinstance(section.get("file"), str):
        return scene
    path = folder / section["file"]
    try:
        digest = hashlib.sha256(path.read_bytes()).hexdigest()[:16]
    except OSError as error:
        raise ModelError(f"section.file must be a mesh of Gmsh, got {path}: {error.strerror or error}") from None
    return scene | {"section": section | {"digest": digest}}


def without_square(scene: Mapping[str, Any]) -> dict[str, Any]:
    """A scene whose section is checked; a square is `geometry.side` alone.

    Raises:
        ModelError: the table is none of a section, or the side is given twice.
    """
    geometry, table = scene["geometry"], scene.get("section")
    if table is None:
        return dict(scene)
    if not isinstance(table, Mapping):
        raise ModelError(f"section must be a table [section], got {table!r}")
    if "side" in geometry:
        raise ModelError(f"geometry.side must be left out where [section] gives the section, got {geometry['side']}")
    section = _checked({"shape": FILE} | dict(table) if "file" in table else dict(table))
    sizes = [section[name] for name in SIZES[section["shape"]]]
    if section["shape"] in (SQUARE, RECTANGLE) and min(sizes) == max(sizes):
        rest = {key: value for key, value in scene.items() if key != "section"}
        return rest | {"geometry": dict(geometry) | {"side": sizes[0]}}
    return dict(scene) | {"section": section}


def _checked(table: dict[str, Any]) -> dict[str, Any]:
    shape = table.get("shape")
    if shape not in SIZES:
        raise ModelError(f"section.shape must be one of {', '.join(SIZES)}, got {shape!r}")
    wanted = {"shape", *SIZES[shape], *(("file", *WRITTEN) if shape == FILE else ())}
    if unknown := sorted(set(table) - wanted):
        raise ModelError(f"section must have the keys {', '.join(sorted(wanted))}, got {unknown[0]}")
    for name in SIZES[shape]:
        if type(table.get(name)) not in (int, float) or not 0 < table[name] < np.inf:
            raise ModelError(f"section.{name} must be finite and above 0 m, got {table.get(name)!r}")
    if shape == RING and not table["bore"] < table["diameter"]:
        raise ModelError(f"section.bore must be below the diameter, {table['diameter']:g} m, got {table['bore']:g}")
    return {name: float(value) if name in SIZES[shape] else value for name, value in table.items()}


def size_of_section(trained: Mapping[str, Any], scene: Mapping[str, Any]) -> float:
    """Size of a scene's section over that of the elements [-].

    Raises:
        ModelError: they differ in shape or ratios.
    """
    own, other = section_of(scene), section_of(trained)
    shape = other["shape"]
    if own["shape"] != shape:
        raise ModelError(f"section.shape must be {shape}, as the elements were trained with, got {own['shape']}")
    if shape == FILE:
        if own.get("digest") != other["digest"]:
            raise ModelError(
                f"section.file must have the content that the elements were trained with, digest {other['digest']}, "
                f"got {own.get('digest')} of {own['file']}"
            )
        return 1.0
    first, *rest = SIZES[shape]
    for name in rest:
        equal(f"section.{name} over section.{first}", own[name] / own[first], other[name] / other[first])
    return float(own[first] / other[first])


def rescaled_section(table: Mapping[str, Any], size: float) -> dict[str, Any]:
    """A section whose lengths are multiplied by a size [-].

    Raises:
        ModelError: a section of a file, whose lengths are in the file.
    """
    if table["shape"] == FILE and size != 1:
        raise ModelError(f"size must be 1 for a section of a file, got {size:.6g}")
    return {name: size * value if name in SIZES[table["shape"]] else value for name, value in table.items()}


def equal(name: str, value: float, wanted: float) -> None:
    """Refuse a number that differs from what elements were trained with.

    Raises:
        ModelError: the name and both values.
    """
    if abs(value - wanted) > NEAR * max(abs(value), abs(wanted)):
        raise ModelError(f"{name} must be {wanted:.6g}, as the elements were trained with, got {value:.6g}")
