"""Commands of a controller to a finger, and limits of its actuators and its object."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rom.answer import Answer
from rom.brief import brief
from rom.console.table import Table, as_html, quantities, row
from rom.parameter import Parameter

MEANING = {
    "converged": "converged",
    "unreachable": "unreachable; these tensions come nearest",
    "out_of_domain": "out of the trained domain",
    "iteration_limit": "not converged",
}


@brief
@dataclass(frozen=True, kw_only=True)
class Motion:
    """A command of a controller to a finger: tensions for a target, and how well they meet it.

    Attributes:
        tensions: [N], then pressures of chambers [Pa], shape (loads,); if the target cannot be met, those that come
            nearest.
        distance: of the plane [m], inf where there is none.
        status: converged, unreachable (the nearest reachable answer), out_of_domain or iteration_limit.
        residual: distance from the target, [m] for reach, [N] for locate and hold.
        error: the model's estimate of its error there, in the residual's unit; meant to cover 95 % of the true ones.
        iterations: evaluations of the model.
        sides: of the finger, along y and z, on which its tendons are pulled: 1 those of the scene, -1 their mirror
            images (in y in free space only, in z before a plane too).
        deviation: standard deviation of `distance` where that was located [m]; else nan.
        unit: of residual and error: m, N or, where a pad's pressure is held, Pa.
        reason: why it is not converged, in a sentence that names argument, value and range; empty if it is.
        pressures: how many of the tensions are pressures, the last ones.
    """

    tensions: np.ndarray
    distance: float
    status: str
    residual: float
    error: float
    iterations: int
    sides: tuple[int, int] = (1, 1)
    deviation: float = np.nan
    unit: str = "N"
    reason: str = ""
    pressures: int = 0

    @property
    def units(self) -> list[str]:
        """Units of the tensions and pressures."""
        return ["N"] * (len(self.tensions) - self.pressures) + ["Pa"] * self.pressures

    @property
    def converged(self) -> bool:
        """True if the target is met."""
        return self.status == "converged"

    def as_json(self) -> dict[str, Any]:
        """Plain numbers."""
        return {
            "tensions": self.tensions.tolist(),
            "units": self.units,
            "distance": self.distance,
            "status": self.status,
            "residual": self.residual,
            "error": self.error,
            "iterations": self.iterations,
            "sides": list(self.sides),
            "deviation": self.deviation,
            "unit": self.unit,
            "reason": self.reason,
        }

    def tables(self, names: Sequence[str] = (), answer: Answer | None = None) -> list[Table | str]:
        """For people.

        Args:
            names: of the tensions and pressures; numbers if left out.
            answer: the model's there, if it is to be shown too.
        """
        labels = names or [f"tension {k + 1}" for k in range(len(self.tensions))]
        rows = [row(*one) for one in zip(labels, self.tensions, self.units, strict=True)]
        if np.isfinite(self.distance):
            rows.append(row("distance d", self.distance, "m", self.deviation if np.isfinite(self.deviation) else None))
        rows.append(row("off the target", self.residual, self.unit, self.error))
        said: list[Table | str] = [quantities(rows, f"{MEANING[self.status]} ({self.iterations} evaluations)")]
        if self.reason:
            said.append(self.reason)
        if answer is not None:
            table, inside = answer.tables(names)
            said += [table, inside]
        return said + [f"tendons pull on the other side along {axis}" for axis in self.mirrored]

    @property
    def mirrored(self) -> list[str]:
        """Axes along which the tendons' mirror images are pulled."""
        return [axis for axis, side in zip("yz", self.sides, strict=True) if side < 0]

    def _repr_html_(self) -> str:
        return as_html(self.tables())


def for_each(name: str, value: ArrayLike, loads: Sequence[Parameter]) -> np.ndarray:
    """A number for every load, shape (loads,); one for all will do where all are tensions.

    Raises:
        ValueError: it is not above 0 and finite, of another shape, or one for tensions and pressures.
    """
    values, units = np.asarray(value, float), {one.unit for one in loads}
    if not ((values > 0) & (values < np.inf)).all():
        raise ValueError(f"{name} must be above 0, got {values.tolist()}")
    if values.shape != (len(loads),) and (values.shape or len(units) > 1):
        raise ValueError(
            f"{name} must be one for each of {', '.join(one.name for one in loads)}, got {values.tolist()}"
        )
    return np.broadcast_to(values, len(loads))


@brief
@dataclass(frozen=True, kw_only=True)
class Limits:
    """Limits of the actuators. The model's trained loads are limits, too.

    Attributes:
        lower, upper: of the tensions [N] and pressures [Pa], one for all or shape (loads,).
        rate: most that a tension changes [N/s]; not of a finger with chambers.
        pad_pressure: largest pressure of the pad that the object withstands [Pa].
    """

    lower: ArrayLike = 0.0
    upper: ArrayLike = np.inf
    rate: float = np.inf
    pad_pressure: float = np.inf

    def within(self, lower: np.ndarray, upper: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The limits within others, shapes (tensions,) [N].

        Raises:
            ValueError: none are left, another number of them, or no rate.
        """
        shape = lower.shape
        for name, ends in (("lower", self.lower), ("upper", self.upper)):
            if np.shape(ends) not in ((), shape):
                raise ValueError(f"limits.{name} must be one number or {shape[0]}, got {ends}")
        own = (
            np.broadcast_to(np.asarray(self.lower, float), shape),
            np.broadcast_to(np.asarray(self.upper, float), shape),
        )
        limits = np.maximum(own[0], lower), np.minimum(own[1], upper)
        if not np.all(limits[0] <= limits[1]):
            raise ValueError(
                f"limits must leave some of the trained tensions [N] and pressures [Pa], {lower.tolist()} to "
                f"{upper.tolist()}, "
                f"got {own[0].tolist()} to {own[1].tolist()}"
            )
        if not self.rate > 0:
            raise ValueError(f"limits.rate must be above 0 N/s, got {self.rate}")
        if not self.pad_pressure > 0:
            raise ValueError(f"limits.pad_pressure must be above 0 Pa, got {self.pad_pressure}")
        return limits
