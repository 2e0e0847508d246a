"""Measured against predicted values of a calibration, a panel a quantity."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from control.calibration.calibration import Calibration
from rom.console.table import shown

if TYPE_CHECKING:  # it is for training, and not where controllers alone are installed
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, HEIGHT, DOTS_PER_INCH = 4.2, 3.4, 110  # of a panel [inches]
UNITS = {"position": "m", "shortening": "m", "orientation": "rad", "angle": "rad"}  # others are relative
COLOURS = ("#1565c0", "#e07000", "#2e7d32", "#6a1b9a")


def draw(result: Calibration) -> Figure:
    """Residuals of every quantity along the log, with twice their noise."""
    from matplotlib.figure import Figure

    groups = result.measured.groups
    figure = Figure(figsize=(WIDTH * len(groups), HEIGHT), layout="constrained")
    for axes, group in zip(np.ravel(figure.subplots(1, len(groups))), groups, strict=True):
        _panel(axes, result, group)
    return figure


def write_plot(result: Calibration, file: Path) -> None:
    """Write the picture in the format that the file's ending names."""
    draw(result).savefig(file, dpi=DOTS_PER_INCH)


def _panel(axes: Axes, result: Calibration, group: str) -> None:
    """The residuals of one quantity, a colour a component."""
    measured, fit = result.measured, result.fit
    factor, unit = shown(UNITS[group]) if group in UNITS else (100.0, "%")
    names = {"position": "xyz", "orientation": ["rx", "ry", "rz"], "contact_force": [""]}.get(
        group, measured.log.tendons
    )
    own = np.flatnonzero(np.array(measured.columns) == group)
    band = 2 * factor * result.noise[group]
    axes.axhspan(-band, band, fc="0.92", lw=0, label="twice the noise")
    for name, column, colour in zip(names, own, COLOURS * len(own), strict=False):
        values = factor * result.noise[group] * fit.residuals[:, column]
        used = measured.used[:, column]
        axes.plot(measured.log.lines[used], values[used], "o", ms=4, color=colour, label=name or None)
    axes.axhline(0.0, color="0.6", lw=0.8)
    axes.set(
        xlabel=f"line of {measured.log.path.name}",
        ylabel=f"model minus measured [{unit}]",
        title=group.replace("_", " "),
    )
    axes.legend(frameon=False, fontsize=8)
