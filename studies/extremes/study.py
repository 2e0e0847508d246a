"""The parts of docs/extremes.md."""

from studies.extremes import extremes

PARTS = {"extremes": extremes.measure}
