"""Contact-aligned coordinates: where the kink of touch becomes a face of the box.

The free finger touches an object at the distance d = D(F), a curved surface. Across it everything has a kink that no
product of one-dimensional functions follows. In contact, the object's distance is therefore replaced by its share of
the path past that surface,

    s = (D(F) - d) / (D(F) - d_min + soft)

which is 0 where the finger just touches and fills nearly the same range at all tensions. `soft` keeps it smooth where
the finger hardly reaches the nearest object. Where another corner leads, D has kinks, which the products smooth.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

SOFT = 0.3  # share of the range of d


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
