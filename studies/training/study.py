"""The parts of docs/appendix.md."""

from studies.training import farm

PARTS = {"farm": farm.measure}
