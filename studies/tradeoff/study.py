"""The parts of docs/tradeoff.md."""

from studies.tradeoff import tradeoff

PARTS = {"tradeoff": tradeoff.measure}
