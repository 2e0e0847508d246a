"""A model without Python: its numbers as a struct fingerfem_model (native/model.h), as a page and an FMU have them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rom.native import EVALUATION, SEGMENT, Library
from rom.rod.native import ENDS
from rom.rod.touched_segment import TouchedSegment
from rom.separated.model import SeparatedModel

_HERE = Path(__file__).parent / "native"
MODEL = Library(
    "model",
    headers=[_HERE / "model.h"],
    units=[_HERE / "model.c", *EVALUATION.units, *SEGMENT.units],
    includes=SEGMENT,
)


def struct(model: SeparatedModel | TouchedSegment) -> Any:
    """A struct fingerfem_model."""
    p = len(model.parameters)
    if isinstance(model, TouchedSegment):
        sections = sum(one.struct.places + ENDS for one in model.rod.segments)
        return MODEL.struct("fingerfem_model", parameters=p, sections=sections, touching=model.touching)
    return MODEL.struct("fingerfem_model", parameters=p, kernel=model.kernel, errors=errors_of(model))


def errors_of(model: SeparatedModel) -> Any:
    """A struct fingerfem_errors."""
    errors = model.errors
    return MODEL.struct(
        "fingerfem_errors",
        tip=errors.tip,
        touch_distance=errors.touch_distance,
        margin=errors.margin,
        columns=errors.contact.shape[1],
        rates=errors.contact,
    )
