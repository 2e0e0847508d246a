"""The parts of docs/training.md."""

from studies.training import farm

PARTS = {"farm": farm.measure}
