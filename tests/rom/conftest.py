"""Elements of an elastic rod, trained once; and a separated model of full-order states."""

import pytest

from rom.build import separate_grid
from rom.dataset.snapshot_set import SnapshotSet
from rom.elements.fitting import training
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


@pytest.fixture(scope="session")
def grid_model(trained):
    """The paper's 4 x 4 x 4 states of the draft finger, with the pad's pressure and the displacement."""
    return separate_grid(SnapshotSet(trained / "training"), held_out=SnapshotSet(trained / "heldout"))


@pytest.fixture(scope="session")
def grid_file(grid_model, tmp_path_factory):
    """Its file."""
    file = tmp_path_factory.mktemp("grid") / "grid.h5"
    grid_model.save(file)
    return file
