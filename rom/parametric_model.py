"""Base of models of tensions and distances: the box of their parameters, and checked points."""

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from rom.answer import TOUCH, Answer
from rom.console.table import Table, as_html
from rom.files.checked_file import ModelError
from rom.parameter import Parameter


class ParametricModel:
    """A model of p parameters: tensions, then distances."""

    if TYPE_CHECKING:

        @property
        def parameters(self) -> list[Parameter]:
            """Tensions, then distances."""

        def tables(self) -> list[Table | str]:
            """Tables for people."""

        def evaluate(self, parameters: ArrayLike, d: ArrayLike | None = None) -> Answer:
            """Outputs with estimated errors, at one point or many."""

        def value_and_jacobian(self, parameters: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
            """Outputs at one point, shape (m,), and their derivatives, shape (m, p)."""

    @property
    def names(self) -> list[str]:
        """Names of the parameters in order."""
        return [parameter.name for parameter in self.parameters]

    @property
    def limits(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper ends of the parameters, shapes (p,) [N, m]."""
        ends = np.array([[parameter.lower, parameter.upper] for parameter in self.parameters], float)
        return ends[:, 0], ends[:, 1]

    @cached_property
    def lead(self) -> int:
        """Index of the tension that pushes most towards a single object, in the middle of all ranges."""
        lower, upper = self.limits
        middle = np.append((lower + upper)[:-1] / 2, np.inf)
        return int(np.argmax(self.jacobian(middle)[TOUCH, :-1]))

    def jacobian(self, parameters: ArrayLike) -> np.ndarray:
        """The derivatives of `value_and_jacobian` alone, shape (m, p)."""
        return self.value_and_jacobian(parameters)[1]

    def _repr_html_(self) -> str:
        return as_html(self.tables())

    def checked(self, parameters: ArrayLike, most: int = 2) -> np.ndarray:
        """One point, shape (p,), or with `most` of 2 many, shape (n, p).

        Raises:
            ModelError: no numbers, or the wrong number of them.
        """
        try:
            point = np.ascontiguousarray(parameters, float)
        except (TypeError, ValueError):
            names = ", ".join(self.names)
            raise ModelError(f"parameters must be numbers, one for each of {names}, got {parameters!r}") from None
        if point.shape[-1:] != (len(self.parameters),) or point.ndim > most:
            names = ", ".join(self.names)
            raise ModelError(f"parameters must be {names} (in that order), got shape {np.shape(parameters)}")
        return point
