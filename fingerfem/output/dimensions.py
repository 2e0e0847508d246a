"""Dimension lines, axes and labels of a technical drawing."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

MM = 1e3  # millimetres per metre
RUBBER, INLAY, PAD = "#f3e9dc", "#c2a878", "#d50000"  # colours
FONT = 12  # [points]: at half size still 9 pixels high
LINE = {"color": "0.25", "lw": 1.0}  # of dimensions


def millimetres(length: float) -> str:
    """A length in mm, for people."""
    return f"{length:.4g} mm"


def finish(axes: Axes, horizontal: str, vertical: str) -> None:
    """Equal scales, labels with units, round numbers."""
    axes.set_aspect("equal")
    axes.set_xlabel(horizontal, fontsize=FONT)
    axes.set_ylabel(vertical, fontsize=FONT)
    axes.tick_params(labelsize=FONT - 1)
    axes.xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
    axes.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    for edge in ("top", "right"):
        axes.spines[edge].set_visible(False)


def arrow(axes: Axes, start: tuple, end: tuple, name: str, beside: tuple[float, float]) -> None:
    """An axis of coordinates with its letter."""
    axes.annotate("", end, start, arrowprops={"arrowstyle": "-|>", "color": "0.1", "lw": 1.5})
    x, y = np.add(end, beside)
    axes.text(x, y, name, ha="center", va="center", style="italic", fontsize=FONT)


def dimension(axes: Axes, start: tuple, end: tuple, name: str, beside: tuple[float, float]) -> None:
    """A line between two arrowheads with a length, which stands below or to the right of it."""
    axes.annotate("", end, start, arrowprops={"arrowstyle": "<|-|>", "shrinkA": 0, "shrinkB": 0, **LINE})
    x, y = np.add(np.add(start, end) / 2, beside)
    below = beside[0] == 0
    axes.text(x, y, name, ha="center" if below else "left", va="top" if below else "center", fontsize=FONT)


def label(axes: Axes, name: str, of: tuple, at: tuple) -> None:
    """A name with a line to what it names."""
    axes.annotate(name, of, at, ha="left", va="center", fontsize=FONT, arrowprops={"arrowstyle": "-", **LINE})
