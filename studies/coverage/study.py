"""The parts of docs/coverage.md."""

from studies.coverage import coverage

PARTS = {"coverage": coverage.measure}
