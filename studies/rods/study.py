"""The parts of docs/segment.md."""

from studies.rods import accuracy, histories, lengths, objects, robustness, speed

PARTS = {
    "accuracy": accuracy.measure,
    "lengths": lengths.measure,
    "objects": objects.measure,
    "histories": histories.measure,
    "robustness": robustness.measure,
    "speed": speed.measure,
}
