"""The parts of a separated model besides its forms: the displacement of all nodes, and the estimated errors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rom.brief import brief


@brief
@dataclass(frozen=True, kw_only=True)
class Field:
    """The displacement of all nodes: modes of the model's own products, F_i(x) = sum_k basis_xk modes_ki.

    Attributes:
        nodes: at rest, shape (nodes, 3) [m].
        basis: POD modes, shape (3 nodes, k), single precision [-].
        free: amounts of these without contact, for every term of the free form, shape (k, terms) [m].
        contact: amounts that contact adds per length of its path, likewise of the contact form [-].
    """

    nodes: np.ndarray
    basis: np.ndarray
    free: np.ndarray
    contact: np.ndarray


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
