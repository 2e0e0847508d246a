"""A finger as compiled code takes it: a struct fingerfem_chain."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rom.rod import compiled
from rom.rod.weight import weight_of

if TYPE_CHECKING:
    from rom.rod.rod import Rod

QUANTITIES = "tip", "contact_force", "touch_distance"  # of which errors are estimated


def chain_of(rod: Rod) -> Any:
    """The struct of a finger.

    Raises:
        ModelError: a finger beyond what compiled code holds.
    """
    own = np.zeros((len(rod.segments), len(rod.names)), int)
    for k, one in enumerate(rod.segments):
        own[k, : one.tensions] = [rod.names.index(name) for name in one.names]
    tip, force, touch = map(rod.elements.error_factor, QUANTITIES)
    errors = {
        "tip_factor": tip,
        "force_factor": force,
        "touch_factor": touch,
        "place_floor": rod.errors.floors.place,
        "force_floor": rod.errors.floors.force,
        "turn_error": rod.errors.turn,
        "shortening_error": rod.errors.shortening,
    }
    weight = weight_of(rod)
    weighs = {} if weight is None else weight._asdict()
    return compiled.chain_struct(
        [one.struct for one in rod.segments], own, rod.rest, rod.errors.surface, errors, weighs
    )
