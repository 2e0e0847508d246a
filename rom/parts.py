"""What a surrogate is made of besides its free answer: contact regimes, the displacement field, its own errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rom.regimes import Code
from rom.separated import Separated


@dataclass(frozen=True, kw_only=True)
class Regime:
    """Contact in one regime, see rom.regimes.

    Attributes:
        code: what carries.
        corner: which of the free form's heights is that of the corner whose way past the plane is its coordinate.
        begins: whether it begins at touch: tip and force are then by that way.
        states: number of states it was fitted to.
        sizes: what its conditions are large or small against.
        form: what contact adds to the tip [m], contact force [N], conditions; by tensions and s.
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
        contact: of tip, contact force and displacement, by way past touch [-, N/m, -], by cell of the map of regimes,
            shape (cells, 3).
        margin: added to the way past touch [m].
    """

    tip: float
    displacement: float
    touch_distance: float
    contact: np.ndarray
    margin: float
