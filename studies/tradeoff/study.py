"""The parts of docs/tradeoff.md."""

from studies.tradeoff import maps, tradeoff

PARTS = {"tradeoff": tradeoff.measure, "maps": maps.measure}
