"""The one C library of models: elements, rods, shapes, contact, separated forms (see the headers)."""

from pathlib import Path
from typing import Any

from rom.native.library import FLAGS, KINDS, Library, NoCompiler, PickledByFields, compiler, kept_by, levels

__all__ = [
    "FLAGS",
    "KINDS",
    "LIBRARY",
    "Library",
    "NoCompiler",
    "PickledByFields",
    "compiler",
    "kept_by",
    "levels",
    "pointer",
]

_HERE = Path(__file__).parent
LIBRARY = Library(
    "rom",
    _HERE,
    headers=["separated/kernel.h", "separated/evaluation.h", "segment.h", "model.h"],
    units=[unit for unit in sorted(_HERE.rglob("*.c")) if unit.name != "evaluation.c"],  # batches.c includes it
)


def pointer(array: Any, kind: str = "double[]") -> Any:
    """Pointer to the numbers of a contiguous NumPy array, for a function of C."""
    return LIBRARY.ffi.from_buffer(kind, array)
