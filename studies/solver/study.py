"""The parts of docs/appendix.md."""

from studies.solver import choices, scenes, speed, tangents

PARTS = {"speed": speed.measure, "tangents": tangents.measure, "choices": choices.measure, "scenes": scenes.measure}
