"""The numbers of a model as a struct fingerfem_model (rom/native/model.h), for a page and an FMU."""

from typing import Any

from rom.native import LIBRARY
from rom.rod.compiled import ENDS
from rom.rod.touched_segment import TouchedSegment
from rom.separated.model import SeparatedModel


def struct(model: SeparatedModel | TouchedSegment) -> Any:
    """A struct fingerfem_model."""
    p = len(model.parameters)
    if isinstance(model, TouchedSegment):
        sections = sum(one.struct.places + ENDS for one in model.rod.segments)
        return LIBRARY.struct("fingerfem_model", parameters=p, sections=sections, touching=model.touching)
    return LIBRARY.struct("fingerfem_model", parameters=p, kernel=model.kernel, errors=errors_of(model))


def errors_of(model: SeparatedModel) -> Any:
    """A struct fingerfem_errors."""
    errors = model.errors
    return LIBRARY.struct(
        "fingerfem_errors",
        tip=errors.tip,
        touch_distance=errors.touch_distance,
        margin=errors.margin,
        columns=errors.contact.shape[-1],
        rates=errors.contact,
    )
