"""The parts of docs/accuracy.md."""

from studies.rods import accuracy, lengths, objects, robustness, speed
from studies.rods.on_rubber import histories, indentation, positions, rubber, several

PARTS = {
    "accuracy": accuracy.measure,
    "lengths": lengths.measure,
    "objects": objects.measure,
    "indentation": indentation.measure,
    "positions": positions.measure,
    "rubber": rubber.measure,
    "several": several.measure,
    "histories": histories.measure,
    "robustness": robustness.measure,
    "speed": speed.measure,
}
