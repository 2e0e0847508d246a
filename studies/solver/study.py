"""The parts of docs/solver.md."""

from studies.solver import choices, scenes, speed

PARTS = {"speed": speed.measure, "choices": choices.measure, "scenes": scenes.measure}
