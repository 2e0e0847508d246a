"""rom: separated surrogates from snapshots (numpy, scipy, h5py, cffi; no DOLFINx)."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rom.native.answer import Answer
    from rom.segment.backed_segment import BackedSegment
    from rom.segment.chain import Chain
    from rom.segment.friction.history import friction_history
    from rom.segment.object_search import find_object
    from rom.segment.objects import Cylinder, Hull, Plane, Sphere, box
    from rom.segment.segment_map import SegmentMap
    from rom.segment.touched_segment import TouchedSegment
    from rom.surrogate import Surrogate

# Where each is.
_HOMES = {
    "Answer": "rom.native.answer",
    "BackedSegment": "rom.segment.backed_segment",
    "Chain": "rom.segment.chain",
    "Cylinder": "rom.segment.objects",
    "Hull": "rom.segment.objects",
    "Plane": "rom.segment.objects",
    "SegmentMap": "rom.segment.segment_map",
    "Sphere": "rom.segment.objects",
    "Surrogate": "rom.surrogate",
    "TouchedSegment": "rom.segment.touched_segment",
    "box": "rom.segment.objects",
    "find_object": "rom.segment.object_search",
    "friction_history": "rom.segment.friction.history",
}
__all__ = [
    "Answer",
    "BackedSegment",
    "Chain",
    "Cylinder",
    "Hull",
    "Plane",
    "SegmentMap",
    "Sphere",
    "Surrogate",
    "TouchedSegment",
    "box",
    "find_object",
    "friction_history",
]


def __getattr__(name: str) -> Any:
    """Import on first use: the snapshot format alone needs no compiled code."""
    if name not in __all__:
        raise AttributeError(f"module 'rom' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
