"""The parts of a separated model besides its forms: the displacement of all nodes, and the estimated errors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rom.brief import brief
from rom.separated.separated_form import Separated


@brief
@dataclass(frozen=True, kw_only=True)
class Field:
    """The displacement of all nodes: amounts of POD modes.

    Attributes:
        nodes: at rest, shape (nodes, 3) [m].
        basis: modes, shape (3 nodes, k), single precision [-].
        free: their amounts without contact, by tensions [m].
        contact: the amounts that contact adds, per length of its path, by tensions and s [-].
    """

    nodes: np.ndarray
    basis: np.ndarray
    free: Separated
    contact: Separated


@brief
@dataclass(frozen=True, kw_only=True)
class Errors:
    """Estimated errors, meant to cover 95 % of the true ones.

    Attributes:
        tip: without contact [m].
        displacement: without contact, root mean square over the nodes [m]; 0 without the field.
        touch_distance: [m].
        contact: of tip, contact force, displacement and, if the model has it, pad pressure, per length of contact path
            [-, N/m, -, Pa/m], by cell, shape (cells, 3 or 4).
        margin: added to the contact path [m].
    """

    tip: float
    displacement: float
    touch_distance: float
    contact: np.ndarray
    margin: float
