"""Elements of an elastic rod, trained once."""

import pytest

from rom.elements import training
from rom.rod.rod import Rod
from tests.rom.elements import elastic_rod


@pytest.fixture(scope="session")
def rod_states():
    return elastic_rod.states(24, 0)


@pytest.fixture(scope="session")
def rod_elements(rod_states):
    return training.train(rod_states, {"states": len(rod_states.inputs)})


@pytest.fixture(scope="session")
def finger(rod_elements):
    """The elastic rod as a finger of one segment."""
    return Rod(elements=rod_elements, scene=elastic_rod.scene())
