"""rom: reduced models of fingers from snapshots (numpy, scipy, h5py, cffi; no DOLFINx)."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rom.answer import Answer
    from rom.dataset.rigid_motion import BaseMotion
    from rom.rod.friction.history import friction_history
    from rom.rod.guides.guided_finger import GuidedFinger
    from rom.rod.guides.history import guide_history
    from rom.rod.motion.moving_finger import MovingFinger
    from rom.rod.objects.search import find_object
    from rom.rod.objects.shapes import Cylinder, Hull, Plane, Sphere, box
    from rom.rod.rod import Rod
    from rom.rod.touched_rod import AmongObjects
    from rom.rod.touched_segment import TouchedSegment
    from rom.separated.model import SeparatedModel
    from rom.separated.rod_source import specialise

# Modules of public names.
_HOMES = {
    "Answer": "rom.answer",
    "BaseMotion": "rom.dataset.rigid_motion",
    "Rod": "rom.rod.rod",
    "Cylinder": "rom.rod.objects.shapes",
    "Hull": "rom.rod.objects.shapes",
    "MovingFinger": "rom.rod.motion.moving_finger",
    "Plane": "rom.rod.objects.shapes",
    "Sphere": "rom.rod.objects.shapes",
    "SeparatedModel": "rom.separated.model",
    "TouchedSegment": "rom.rod.touched_segment",
    "AmongObjects": "rom.rod.touched_rod",
    "box": "rom.rod.objects.shapes",
    "find_object": "rom.rod.objects.search",
    "friction_history": "rom.rod.friction.history",
    "GuidedFinger": "rom.rod.guides.guided_finger",
    "guide_history": "rom.rod.guides.history",
    "specialise": "rom.separated.rod_source",
}
__all__ = [
    "Answer",
    "BaseMotion",
    "Rod",
    "Cylinder",
    "Hull",
    "MovingFinger",
    "Plane",
    "SeparatedModel",
    "Sphere",
    "TouchedSegment",
    "AmongObjects",
    "box",
    "find_object",
    "friction_history",
    "GuidedFinger",
    "guide_history",
    "load",
    "specialise",
]


def load(path: str | Path | None = None, tolerance: float = 0.0) -> TouchedSegment | SeparatedModel:
    """Read a model file of any kind: a finger of elements, before the plane y = side/2 + d, or a separated model.

    Args:
        path: the file, or the name of a bundled finger: "finger", "round" or "square"; None reads the first.
        tolerance: of a separated model: keep only the terms needed for this relative separation error [-]; 0 keeps all.

    Raises:
        ModelError: no file, no model, a damaged one, or one of another format.
        ValueError: a tolerance for a finger of elements, which has no terms to leave out.

    Example:
        >>> load().evaluate([30.0, 0.0], d=0.010).contact_force
        >>> load("round").rod.place([2.0, 0.0, 0.0, 0.0]).centres[-1]  # doctest: +SKIP
    """
    from rom.bundled import file_of
    from rom.files.checked_file import kind_of
    from rom.rod import rod
    from rom.rod.touched_segment import TouchedSegment
    from rom.separated.model import SeparatedModel

    if path is not None and kind_of(file_of(path)) != rod.KIND:
        return SeparatedModel.load(path, tolerance=tolerance)
    if tolerance:
        raise ValueError(f"tolerance must be left out for a finger of elements, got {tolerance:g}")
    return TouchedSegment.load(path)


def __getattr__(name: str) -> Any:
    """Import on first use: the snapshot format alone needs no compiled code."""
    if name not in __all__:
        raise AttributeError(f"module 'rom' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
