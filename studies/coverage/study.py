"""The parts of docs/accuracy.md."""

from studies.coverage import coverage

PARTS = {"coverage": coverage.measure}
