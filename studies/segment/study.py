"""The parts of docs/segment.md."""

from studies.segment import accuracy, chains, objects, robustness, speed

PARTS = {
    "accuracy": accuracy.measure,
    "objects": objects.measure,
    "chains": chains.measure,
    "robustness": robustness.measure,
    "speed": speed.measure,
}
