"""The parts of docs/appendix.md."""

from studies.extremes import extremes

PARTS = {"extremes": extremes.measure}
