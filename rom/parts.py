"""What a surrogate is made of besides its free answer, and what it answers: regimes, field, errors, answers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rom.regimes import Code
from rom.separated import Separated


@dataclass(frozen=True, kw_only=True)
class Answer:
    """What the surrogate says at one point, shapes without n, or at n points.

    Attributes:
        tip: displacement of the tip plate's centre, shape (3,) or (n, 3) [m].
        contact_force: [N], shape () or (n,); zero before touch and in scenes without an obstacle.
        touch_distance: how far the free finger reaches towards the plane [m], shape () or (n,); nan without one.
        pad_pressure: mean contact pressure on the tactile pad [Pa], as the contact force; None if the model does not
            know it.
        error: that 95 % of fresh states keep, by quantity in its unit, shapes as the quantities without components.
        inside: whether the point lies in the trained box (a plane that is not touched may stand anywhere, d = inf too).
            Outside, the answer is that of the nearest point inside, and nothing says how far it is from the truth.
    """

    tip: np.ndarray
    contact_force: Any
    touch_distance: Any
    pad_pressure: Any
    error: Mapping[str, Any]
    inside: Any


@dataclass(frozen=True, kw_only=True)
class Regime:
    """Contact in one regime, see rom.regimes.

    Attributes:
        code: what carries.
        corner: which of the free form's heights is that of the corner whose way past the plane is its coordinate.
        begins: whether it begins at touch: tip and force are then by that way.
        states: number of states it was fitted to.
        sizes: what its conditions are large or small against.
        form: what contact adds to the tip [m], contact force [N], conditions, pad pressure [Pa] if it is known; by
            tensions and s.
    """

    code: Code
    corner: int
    begins: bool
    states: int
    sizes: Sequence[float]
    form: Separated


@dataclass(frozen=True, kw_only=True)
class Field:
    """The displacement of all nodes.

    Attributes:
        free_basis: principal components in free space, shape (3 nodes, k), single precision.
        free: their amounts by tensions [m].
        contact_basis: principal components of what contact adds; None without an obstacle.
        regimes: their amounts in every regime, as in Regime.form.
    """

    free_basis: np.ndarray
    free: Separated
    contact_basis: np.ndarray | None = None
    regimes: Sequence[Separated] = ()


@dataclass(frozen=True, kw_only=True)
class Errors:
    """What the surrogate knows of its own error, see rom.error_map: that 95 % of fresh states keep.

    Attributes:
        tip: in free space [m].
        displacement: in free space, root mean square over the nodes [m]; 0 without the field.
        touch_distance: [m].
        contact: of tip, contact force, displacement and pad pressure, if that is known, by way past touch [-, N/m, -,
            Pa/m], by cell of the map of regimes, shape (cells, 3 or 4).
        margin: added to the way past touch [m].
    """

    tip: float
    displacement: float
    touch_distance: float
    contact: np.ndarray
    margin: float
