"""The parts of docs/segment.md."""

from studies.segment import accuracy, objects, robustness, speed

PARTS = {
    "accuracy": accuracy.measure,
    "objects": objects.measure,
    "robustness": robustness.measure,
    "speed": speed.measure,
}
