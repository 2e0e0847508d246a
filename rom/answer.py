"""What a model of tensions and a distance answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True, kw_only=True)
class Answer:
    """What the surrogate says at one point, shapes without n, or at n points.

    Attributes:
        tip: displacement of the tip plate's centre, shape (3,) or (n, 3) [m].
        contact_force: [N], shape () or (n,); zero before touch and in scenes without an obstacle.
        touch_distance: how far the free finger reaches towards the plane [m], shape () or (n,); nan without one.
        pad_pressure: mean contact pressure on the tactile pad [Pa], as the contact force; None if the model does not
            know it.
        error: the estimated one, at most exceeded by 5 % of states, by quantity in its unit, shapes as the quantities
            without components.
        inside: whether the point lies in the trained box (a plane that is not touched may stand anywhere, d = inf too).
            Outside, the answer is that of the nearest point inside, and nothing says how far it is from the truth.
    """

    tip: np.ndarray
    contact_force: Any
    touch_distance: Any
    pad_pressure: Any
    error: Mapping[str, Any]
    inside: Any
