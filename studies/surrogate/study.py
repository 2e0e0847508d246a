"""The parts of docs/surrogate.md."""

from studies.surrogate import accuracy, plain, speed, two_meshes

PARTS = {
    "accuracy": accuracy.measure,
    "plain": plain.measure,
    "speed": speed.measure,
    "two_meshes": two_meshes.measure,
}
FULL_ONLY = ("two_meshes",)  # tradeoff has a short form of two meshes
