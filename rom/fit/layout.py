"""Which column of what is fitted, separated and stored is which; rom/native/evaluation.c reads them so."""

from __future__ import annotations

from dataclasses import dataclass

TIP = slice(0, 3)  # of the free response and of every regime [m]
HEIGHTS = slice(3, None)  # of the free response: touch heights [m]
FORCE = 3  # of a regime [N]
OUTPUTS = slice(0, 4)  # of a regime: tip and force


def height(k):
    """Column of the k-th touch height in the free response; of several, if k is an array."""
    return 3 + k


@dataclass(frozen=True)
class RegimeLayout:
    """Columns of a regime's form: tip, contact force, its conditions, and the pad's pressure if that is known.

    Attributes:
        conditions: their number.
        has_pad: whether the pad's pressure is known.
    """

    conditions: int
    has_pad: bool

    @property
    def condition_columns(self) -> slice:
        """Columns of the conditions."""
        return slice(4, 4 + self.conditions)

    @property
    def count(self) -> int:
        """Number of columns."""
        return 4 + self.conditions + self.has_pad

    @property
    def names(self) -> list[str]:
        """Name of every column."""
        pad = ["pad_pressure"] * self.has_pad
        return ["x", "y", "z", "contact_force", *["condition"] * self.conditions, *pad]

    def units(self, per: str) -> str:
        """Units of all columns; those of a regime that begins at touch are `per` path past it, "/m"."""
        pad = [f"Pa{per}"] * self.has_pad
        return ", ".join([f"m{per}"] * 3 + [f"N{per}"] + ["-"] * self.conditions + pad)
