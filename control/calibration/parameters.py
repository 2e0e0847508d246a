"""The parameters that a log can determine: their units, their starting values, and how far from these they may lie."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rom.brief import brief

# Unit, and a plausible deviation [-], of every parameter that is positive, fitted by its logarithm.
POSITIVE = {"modulus": ("Pa", 1.0), "size": ("m", 0.2), "density": ("kg/m^3", 0.5), "pulley_radius": ("m", 0.2)}
PLACE = ("base_x", "base_y", "base_z")  # of the clamp in the frame of the measured positions [m]
TURN = ("base_rx", "base_ry", "base_rz")  # rotation vector of its frame [rad]
OTHERS = {
    **dict.fromkeys(PLACE, ("m", 0.1)),
    **dict.fromkeys(TURN, ("rad", 0.2)),
    "friction": ("-", 0.2),
}  # of places over the length [-]
NAMED = {**{name: (name,) for name in (*POSITIVE, "friction")}, "base": (*PLACE, *TURN)}  # names for users
DETERMINED = 0.5  # largest standard deviation of a parameter that is determined, over its plausible deviation [-]


@brief
@dataclass(frozen=True, kw_only=True)
class Unknowns:
    """The p unknowns of a calibration, as a vector that is zero where the parameters have their starting values.

    Attributes:
        names: of the parameters.
        starts: starting values of all parameters, also of those that are not fitted, by name.
        length: of the finger [m].
    """

    names: Sequence[str]
    starts: Mapping[str, float]
    length: float

    @property
    def spreads(self) -> np.ndarray:
        """Plausible deviations of the unknowns, shape (p,)."""
        of = {name: spread for name, (_, spread) in (POSITIVE | OTHERS).items()}
        of |= {name: self.length * of[name] for name in PLACE}
        return np.array([of[name] for name in self.names])

    def values(self, unknowns: np.ndarray) -> dict[str, float]:
        """The values of all parameters."""
        numbers = dict(self.starts)
        for name, change in zip(self.names, unknowns.tolist(), strict=True):
            numbers[name] = numbers[name] * float(np.exp(change)) if name in POSITIVE else numbers[name] + change
        return numbers

    def index(self, name: str) -> int | None:
        """Position of a parameter among the unknowns; None if it is not fitted."""
        return self.names.index(name) if name in self.names else None

    def interval(self, name: str, value: float, half: float) -> tuple[float, float]:
        """Ends of an interval of a half width in the unknown."""
        if name in POSITIVE:
            return value * float(np.exp(-half)), value * float(np.exp(half))
        return value - half, value + half


def unit_of(name: str) -> str:
    """The SI unit of a parameter."""
    return (POSITIVE | OTHERS)[name][0]
