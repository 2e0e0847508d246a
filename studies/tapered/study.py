"""The parts of docs/tapered.md."""

from studies.tapered import tapered

PARTS = {"tapered": tapered.measure}
