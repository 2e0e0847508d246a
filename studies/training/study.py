"""The parts of docs/training.md."""

from studies.training import farm, refinement

PARTS = {"farm": farm.measure, "refinement": refinement.measure}
