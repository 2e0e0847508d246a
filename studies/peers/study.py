"""The parts of docs/peers.md."""

from studies.peers import ours, reference
from studies.peers.calculix import bar
from studies.peers.felupe import comparison as felupe
from studies.peers.speed import comparison as speed
from studies.peers.surrogates import training_states

PARTS = {
    "reference": reference.measure,
    "ours": ours.measure,
    "finite_elements": felupe.measure,
    "boundary": felupe.boundary,
    "bar": bar.measure,
    "speed": speed.measure,
    "training_states": training_states.measure,
    # By the Python that has other packages: python -m studies.peers.others.
    "rods": None,
    "calculix": None,
    "surrogates": None,
}
FULL_ONLY = ("finite_elements", "boundary", "speed", "training_states", "rods", "calculix", "surrogates")
