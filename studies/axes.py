"""Pictures that can be read at half their size: large letters, plain numbers on logarithmic axes."""

from __future__ import annotations

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.ticker import FormatStrFormatter, NullFormatter


def large_letters() -> None:
    """Set the letters of all pictures that this process draws [pt]."""
    mpl.rcParams.update({"font.size": 13, "axes.titlesize": 13, "legend.fontsize": 11})


def logarithmic(axes: Axes) -> None:
    """Plain numbers as ticks."""
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(FormatStrFormatter("%g"))
        axis.set_minor_formatter(NullFormatter())
