"""The parts of docs/tradeoff.md."""

from studies.tradeoff import rods, tradeoff

PARTS = {"tradeoff": tradeoff.measure, "rods": rods.measure}
