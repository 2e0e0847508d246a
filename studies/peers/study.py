"""The parts of docs/peers.md."""

from studies.peers import ours, reference
from studies.peers.calculix import bar
from studies.peers.felupe import comparison as felupe
from studies.peers.speed import comparison as speed

PARTS = {
    "reference": reference.measure,
    "ours": ours.measure,
    "finite_elements": felupe.measure,
    "boundary": felupe.boundary,
    "bar": bar.measure,
    "speed": speed.measure,
    # By the Python that has other packages: python -m studies.peers.others.
    "rods": None,
    "calculix": None,
}
FULL_ONLY = ("finite_elements", "boundary", "speed", "rods", "calculix")
