"""The sections of a finger at rest, by the geometry of its scene as plain data: a tapered one has several sizes."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rom.dataset.grid import SHARE

END = 1.0  # length of rubber in a clamp or plate piece, over the side: nearer, the section cannot warp freely [-]


def sizes_of(geometry: Mapping[str, Any]) -> np.ndarray:
    """Sizes of the segments' sections from the clamp to every plate, shape (segments + 1,), over the clamp's [-]."""
    return np.cumprod([1.0, *(geometry.get("taper") or [1.0] * len(geometry["segments"]))])


def plates_of(geometry: Mapping[str, Any]) -> np.ndarray:
    """Start and end of every segment's plate along the finger, shape (segments, 2) [m]."""
    ends = np.cumsum(geometry["segments"])
    return np.column_stack([ends - geometry["plate"] * sizes_of(geometry)[1:], ends])


def rubber_of(geometry: Mapping[str, Any]) -> np.ndarray:
    """Start and end of every segment's rubber along the finger, shape (segments, 2) [m]."""
    plates = plates_of(geometry)
    return np.column_stack([np.append(0.0, plates[:-1, 1]), plates[:, 0]])


def is_all_along(geometry: Mapping[str, Any], x: Sequence[float] | None) -> bool:
    """True if a part of the axis, from and to [m], contains all rubber; None does."""
    return x is None or (x[0] <= 0 and x[1] >= plates_of(geometry)[-1, 0] * (1 - SHARE))


def steepest(geometry: Mapping[str, Any], side: float) -> float:
    """Largest change of a side, that at the clamp [m], per length of rubber [-]."""
    lengths = np.diff(rubber_of(geometry))[:, 0]
    return float(side * np.max(np.abs(np.diff(sizes_of(geometry))) / lengths))


def size_at(geometry: Mapping[str, Any], x: ArrayLike) -> np.ndarray:
    """Size of the sections at x along the finger [m] over the clamp's [-]: linear along rubber, constant in plates."""
    sizes = np.append(1.0, np.repeat(sizes_of(geometry)[1:], 2))
    return np.interp(np.asarray(x, float), np.append(0.0, plates_of(geometry)), sizes)


def tip_at_rest(geometry: Mapping[str, Any]) -> np.ndarray:
    """The tip plate's centre in the undeformed finger, shape (3,) [m]."""
    return np.array([plates_of(geometry)[-1].mean(), 0.0, 0.0])
