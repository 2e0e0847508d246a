"""Unknowns of a contact: their ranges, what is expected of them, and the call of compiled code."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from control.least_squares import Rules, struct
from control.native import CONTROL
from control.outcomes import beyond
from rom.brief import brief
from rom.dataset.actuators import refuse_chambers
from rom.native import pointer
from rom.rod.rod import Rod

EVEN = np.sqrt(12.0)  # range over the standard deviation of an even distribution on it [-]
ITERATIONS = 40  # most evaluations from one start
# a residual below 0.03 standard deviations counts as zero; steps end at 0.3 % of a range and of the cost
RULES = Rules(residual=0.03, longest=0.4, step=3e-3, nearest=1.0, null_space_iterations=0, iterations=ITERATIONS)


@brief
@dataclass(frozen=True)
class Unknowns:
    """The unknowns of a contact.

    Attributes:
        names: of the k unknowns.
        rod: the finger, with t tendons.
        ranges: of tensions, then unknowns, shape (2, t + k).
        touching: a struct fingerfem_touching with objects whose distances are unknown; None: a force is.

    Raises:
        ValueError: a finger without laws of shortenings, or with chambers.
    """

    names: tuple[str, ...]
    rod: Rod
    ranges: np.ndarray
    touching: Any = None

    def __post_init__(self) -> None:
        if not self.rod.struct.segments[0].sixes:
            raise ValueError("model must have laws of shortenings to feel a contact, got one without: train it again")
        refuse_chambers(self.rod.scene, "control.feel")

    @cached_property
    def felt(self) -> Any:
        """A struct control_felt; its ranges are those of a call."""
        touching = self.touching or CONTROL.ffi.NULL
        return CONTROL.struct("control_felt", chain=self.rod.struct, touching=touching, unknowns=len(self.names))

    def expected(self, known: Mapping[str, tuple[float, float]]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Ranges, shape (2, t + k), of which known unknowns have equal ends; values and deviations, shapes (k,)."""
        k = len(self.names)
        ranges, (lower, upper) = self.ranges.copy(), self.ranges[:, -k:]
        values, deviations = (lower + upper) / 2, (upper - lower) / EVEN
        for name, (value, deviation) in known.items():
            if name not in self.names:
                raise ValueError(f"expected must name {', '.join(self.names)}, got {name}")
            own = self.names.index(name)
            reason = beyond(f"expected {name}", value, lower[own], upper[own], "") or beyond(
                f"deviation of the expected {name}", deviation, 0.0, np.finfo(float).max, ""
            )
            if reason:
                raise ValueError(reason)
            values[own] = value
            if deviation > 0:
                deviations[own] = deviation
            else:
                ranges[:, own - k] = value
        return ranges, values, deviations

    def solved(
        self, measured: Sequence[np.ndarray], ranges: np.ndarray, hint: np.ndarray | None, limit: float
    ) -> tuple[Any, dict[str, np.ndarray]]:
        """A struct control_feeling, and the arrays that it points to, by name.

        Args:
            measured: the fields of a struct control_measured.
            ranges: see `expected`.
            hint: where to begin, shape (k,); None begins at several places.
            limit: of chi_square, up to which an answer is taken.
        """
        felt, ffi, lib = self.felt, CONTROL.ffi, CONTROL.functions
        n, k, m = ranges.shape[1], len(self.names), self.touching.count if self.touching else 0
        shapes: dict[str, tuple[int, ...]] = {
            "variables": (n,),
            "covariance": (n, n),
            "forces": (m,),
            "force_covariance": (m, m),
            "axes": (k, k),
            "visible": (k,),
            "other": (n,),
        }
        arrays = {name: np.empty(shape) for name, shape in shapes.items()}
        feeling = ffi.new("control_feeling *")
        readings = ffi.new("control_measured *", [pointer(one) for one in measured])
        for name, array in arrays.items():
            setattr(feeling, name, pointer(array))
        felt.lower, felt.upper = map(pointer, ranges)
        memory = np.empty(lib.control_feel_memory(felt))
        begin = ffi.NULL if hint is None else pointer(hint)
        lib.control_feel(felt, readings, begin, limit, struct(RULES), pointer(memory), feeling)
        return feeling, arrays
