"""Pictures that can be read at half their size: large letters, plain numbers on logarithmic axes."""

from __future__ import annotations

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

LETTERS, OF_LEGENDS = 13, 11  # [pt]


def large_letters() -> None:
    """Of all pictures that this process draws from here on."""
    mpl.rcParams["font.size"] = mpl.rcParams["axes.titlesize"] = LETTERS
    mpl.rcParams["legend.fontsize"] = OF_LEGENDS


def logarithmic(axes: Axes, which: str = "xy") -> None:
    """Plain numbers as ticks."""
    for axis, name in ((axes.xaxis, "x"), (axes.yaxis, "y")):
        if name in which:
            low, high = axis.get_view_interval()
            axis.set_major_locator(LogLocator(subs=(1,) if high > 300 * low else (1, 2, 5), numticks=12))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axis.set_minor_formatter(NullFormatter())
