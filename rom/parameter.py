"""The parameters of a model: tensions, then distances."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike


class Parameter(NamedTuple):
    """A tension or a distance.

    Attributes:
        name: of a tendon, or d.
        unit: N or m.
        lower: end of the trained range, in the unit.
        upper: likewise.

    Example:
        >>> load().parameters[0].upper
        100.0
    """

    name: str
    unit: str
    lower: float
    upper: float

    def as_json(self) -> dict[str, Any]:
        """Plain data."""
        return self._asdict()


def joined(tensions: ArrayLike, d: ArrayLike, distances: int = 1) -> np.ndarray:
    """Points of tensions and distances, shape (p,) or (n, p) [N, m].

    Args:
        tensions: shape (t,) or (n, t) [N].
        d: shape () or (n,) for one distance, else (distances,) or (n, distances) [m].
        distances: how many a point has.

    Raises:
        ValueError: no row of tensions, another number of distances, or the numbers of points differ.
    """
    parts = np.asarray(tensions, float), np.asarray(d, float)[..., None] if distances == 1 else np.asarray(d, float)
    if not parts[0].ndim or parts[1].shape[-1:] != (distances,):
        raise ValueError(f"tensions must be a row, and d {distances} a point, got {tensions!r} and {d!r}")
    points = np.broadcast_shapes(*(part.shape[:-1] for part in parts))
    return np.concatenate([np.broadcast_to(part, (*points, part.shape[-1])) for part in parts], axis=-1)
