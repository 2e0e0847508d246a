"""The parts of docs/accuracy.md."""

from studies.tapered import tapered

PARTS = {"tapered": tapered.measure}
