"""Logarithmic axes that can be read: plain numbers, and letters that stand half the size."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter, NullLocator

STEPS = ((1,), (1, 3), (1, 2, 5), (1, 1.5, 2, 3, 4, 5, 7))  # of ticks within a decade: the first that give enough
ENOUGH = 5  # ticks of an axis
LETTERS, OF_LEGENDS = 13, 11  # [pt]


def large_letters() -> None:
    """Of all pictures that this process draws from here on."""
    mpl.rcParams["font.size"] = mpl.rcParams["axes.titlesize"] = LETTERS
    mpl.rcParams["legend.fontsize"] = OF_LEGENDS


def logarithmic(axes: Axes, which: str = "xy") -> None:
    """Ticks of axes that have their data and their limits."""
    for axis, name in ((axes.xaxis, "x"), (axes.yaxis, "y")):
        if name in which:
            _ticks(axis)


def _ticks(axis: Axis) -> None:
    low, high = sorted(axis.get_view_interval())
    found = [ticks(low, high, steps) for steps in STEPS]
    chosen = next((values for values in found if len(values) >= ENOUGH), found[-1])
    axis.set_major_locator(FixedLocator(chosen))
    axis.set_major_formatter(FuncFormatter(lambda value, _: plain(value)))
    axis.set_minor_locator(NullLocator())
    axis.set_minor_formatter(NullFormatter())


def ticks(low: float, high: float, steps: tuple[float, ...]) -> list[float]:
    """Numbers of these steps within an interval of positive numbers."""
    decades = range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high))) + 1)
    return [value for k in decades for step in steps if low <= (value := float(f"{step}e{k}")) <= high]


def plain(value: float) -> str:
    """1000 is 1,000; 0.05 is 0.05; 2e-5 is 2e-5."""
    return f"{value:g}".replace("e-0", "e-") if value < 1e-3 else f"{value:,.10g}"
