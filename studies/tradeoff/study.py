"""The parts of docs/speed.md."""

from studies.tradeoff import rods, tradeoff

PARTS = {"tradeoff": tradeoff.measure, "rods": rods.measure}
