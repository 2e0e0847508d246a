"""The parts of docs/figures.md."""

from studies.figures import figures

PARTS = {"figures": figures.measure}
