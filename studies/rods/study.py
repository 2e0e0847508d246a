"""The parts of docs/segment.md."""

from studies.rods import (
    accuracy,
    histories,
    indentation,
    lengths,
    objects,
    positions,
    robustness,
    rubber,
    several,
    speed,
)

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
