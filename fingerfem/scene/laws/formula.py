"""Invariants and functions in energy formulas, which UFL and NumPy share."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np


class Maths(NamedTuple):
    """Functions of UFL or of NumPy; `number` makes a constant of the compiled forms, or leaves it."""

    number: Callable[[float], Any]
    ln: Callable[[Any], Any]


NUMPY = Maths(lambda value: value, np.log)


class Invariants(NamedTuple):
    """Invariants of C = F^T F [-]: I1 = tr C, I2 = (I1^2 - tr C^2) / 2, J = det F; UFL or NumPy, of one shape."""

    I1: Any
    I2: Any
    J: Any

    @property
    def I1bar(self) -> Any:
        """J^(-2/3) I1 [-], which a change of volume alone leaves at 3."""
        return self.J ** (-2 / 3) * self.I1

    @property
    def I2bar(self) -> Any:
        """J^(-4/3) I2 [-], likewise."""
        return self.J ** (-4 / 3) * self.I2
