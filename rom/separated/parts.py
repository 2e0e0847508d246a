"""The parts of a separated model besides its forms: coordinates, the displacement of all nodes, estimated errors.

The free finger touches an object at the distance d = D(F), a curved surface. Across it everything has a kink that no
product of one-dimensional functions follows. In contact, the object's distance is therefore replaced by its share of
the path past that surface,

    s = (D(F) - d) / (D(F) - d_min + soft)

which is 0 where the finger just touches and fills nearly the same range at all tensions. `soft` keeps it smooth where
the finger hardly reaches the nearest object. Where another corner leads, D has kinks, which the products smooth.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rom.brief import brief

SOFT = 0.3  # share of the range of d [-]


class ContactCoordinates(NamedTuple):
    """Tensions and the share s of the contact path.

    Attributes:
        nearest: distance of the object [m].
        soft: [m].
    """

    nearest: float
    soft: float

    def of(self, parameters: np.ndarray, height: np.ndarray) -> np.ndarray:
        """Tensions, then s: shape (n, p), of parameters, shape (n, p), and touch distances D, shape (n,) [m]."""
        found = np.array(parameters)
        found[:, -1] = (height - parameters[:, -1]) / (height - self.nearest + self.soft)
        return found


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
        margin: added to the contact path [m]. It is at least the error of the touch distance.
    """

    tip: float
    displacement: float
    touch_distance: float
    contact: np.ndarray
    margin: float
