"""Contact-aligned coordinates: where the kink of touch becomes a face of the box.

A corner that reaches the height D(F) in free space, at tensions F, is touched on the curved surface d = D(F); across
it everything has a kink that no product of one-dimensional functions follows. In contact, the plane's distance is
therefore replaced by how far it is past that surface,

    s = (D(F) - d) / (D(F) - d_min + soft)

which is 0 where the corner is just touched and fills nearly the same range at all tensions. `soft` keeps it smooth
where the corner hardly reaches the nearest plane. D is that of the regime's own corner: which corner leads, and with
it the touch distance, has kinks of its own.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

SOFT = 0.3  # share of the range of d


class ContactCoordinates(NamedTuple):
    """Tensions and the plane's relative penetration s past a corner.

    Attributes:
        nearest: distance of the plane [m].
        soft: [m].
    """

    nearest: float
    soft: float

    @staticmethod
    def over(nearest: float, farthest: float, heights: np.ndarray) -> ContactCoordinates:
        """Coordinates for a range of d [m] and the heights of the regimes' corners in free space, shape (n,) [m]."""
        lowest = max(nearest - float(heights.min()), 0.0)
        return ContactCoordinates(nearest, max(SOFT * (farthest - nearest), 2 * lowest))

    def of(self, parameters: np.ndarray, height: np.ndarray) -> np.ndarray:
        """Tensions, then s: shape (n, p), of parameters, shape (n, p), and the corner's heights D, shape (n,) [m]."""
        found = np.array(parameters)
        found[:, -1] = (height - parameters[:, -1]) / (height - self.nearest + self.soft)
        return found

    def slopes(
        self, parameters: np.ndarray, height: np.ndarray, height_jacobian: np.ndarray, slopes: np.ndarray
    ) -> np.ndarray:
        """Derivatives by the coordinates, shape (n, m, p), from `slopes`, those by the parameters of the same shape.

        With d = D - s (D - d_min + soft), by the chain rule; `height_jacobian` is dD/dF, shape (n, p - 1).
        """
        s, whole = self.of(parameters, height)[:, -1], height - self.nearest + self.soft
        by_distance = slopes[..., -1]
        found = np.empty_like(slopes)
        for k in range(height_jacobian.shape[1]):
            found[..., k] = slopes[..., k] + by_distance * ((1 - s) * height_jacobian[:, k])[:, None]
        found[..., -1] = -by_distance * whole[:, None]
        return found
