"""The parts of docs/segment.md."""

from studies.segment import accuracy, chains, objects, robustness, separation, speed

PARTS = {
    "accuracy": accuracy.measure,
    "separation": separation.measure,
    "objects": objects.measure,
    "chains": chains.measure,
    "robustness": robustness.measure,
    "speed": speed.measure,
}
