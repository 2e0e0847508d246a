"""Measured stresses and fitted laws, a panel a test; where there are no data, it is hatched."""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fingerfem.material_fit.fit import Comparison
from fingerfem.material_fit.measurements import Measurement
from fingerfem.material_fit.stresses import nominal_stress

COLOURS = {"neo-hookean": "#1565c0", "mooney-rivlin": "#2e7d32", "yeoh": "#e07000", "ogden": "#6a1b9a"}
WIDTH, HEIGHT, DOTS_PER_INCH = 5.0, 4.2, 110  # of a panel [inches]
BEYOND = 0.25  # of the logarithmic range of the data: how far curves go on, either way [-]
KPA = 1e-3  # kilopascals per pascal


def draw(comparison: Comparison) -> Figure:
    """The picture."""
    count = len(comparison.measurements)
    figure = Figure(figsize=(WIDTH * count, HEIGHT), layout="constrained")
    for axes, measurement in zip(np.ravel(figure.subplots(1, count)), comparison.measurements, strict=True):
        _panel(axes, comparison, measurement)
    return figure


def write_plot(comparison: Comparison, file: Path) -> None:
    """Write the picture in the format that the file's ending names."""
    draw(comparison).savefig(file, dpi=DOTS_PER_INCH)


def _panel(axes: Axes, comparison: Comparison, measurement: Measurement) -> None:
    """One test."""
    first, last = measurement.stretch[0], measurement.stretch[-1]
    first, last = min(first, 1.0), max(last, 1.0)  # at rest there is no stress: no guess
    left, right = first * (first / last) ** BEYOND, last * (last / first) ** BEYOND
    stretch = np.geomspace(left, right, 200)
    axes.plot(measurement.stretch, KPA * measurement.stress, "o", ms=4, mfc="none", mec="0.35", label="measured")
    for fit in comparison.fits:
        if fit.law is not None:
            chosen = fit is comparison.chosen
            look: dict[str, Any] = {"lw": 2.4, "ls": "-"} if chosen else {"lw": 1.0, "ls": "--"}
            look |= {"color": COLOURS[fit.name], "label": f"{fit.name} (chosen)" if chosen else fit.name}
            axes.plot(stretch, KPA * nominal_stress(fit.law, measurement.mode, stretch), **look)
    for begin, end in ((left, first), (last, right)):
        axes.axvspan(begin, end, fc="0.96", ec="0.8", hatch="///", lw=0, zorder=0)
    room = 1.6 * KPA * measurement.peak  # a curve beyond the data may be far away
    low, high = axes.get_ylim()
    axes.set(xlim=(left, right), ylim=(max(low, -room), min(high, room)))
    axes.set(title=measurement.mode, xlabel="stretch [-], hatched: no data", ylabel="nominal stress [kPa]")
    axes.legend(frameon=False)
