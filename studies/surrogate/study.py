"""The parts of docs/surrogate.md."""

from studies.surrogate import accuracy, plain, speed, states, two_meshes

PARTS = {
    "accuracy": accuracy.measure,
    "plain": plain.measure,
    "speed": speed.measure,
    "states": states.measure,
    "others": None,  # by the Python that has other packages: python -m studies.surrogate.others
    "two_meshes": two_meshes.measure,
}
FULL_ONLY = ("states", "others", "two_meshes")  # tradeoff has a short form of two meshes
