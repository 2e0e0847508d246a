"""The paper's method on full-order states: a grid of them, separated by alternating directions on its own nodes."""

from dataclasses import replace

import numpy as np
import pytest
from farm import run

from rom.build import separate_grid
from rom.dataset.snapshot_set import SnapshotError, SnapshotSet
from rom.separated.alternating_directions import EnrichmentOptions
from rom.separated.grid_source import grid_samples
from rom.separated.tabulated import tabulated

FEWER = EnrichmentOptions(terms=60)


@pytest.fixture(scope="module")
def grid(scene, tmp_path_factory) -> SnapshotSet:
    """Seven nodes an axis of a coarse finger."""
    folder = tmp_path_factory.mktemp("grid")
    file = folder / "grid.toml"
    file.write_text(scene.read_text().replace("nodes = 4", "nodes = 7"))
    run(2, file, folder / "set")
    return SnapshotSet(folder / "set")


def relative_errors(model, snapshots: SnapshotSet) -> np.ndarray:
    """Relative errors of contact forces above 0.5 N at states."""
    true = snapshots.answered("contact_force")
    felt = true > 0.5
    return np.abs(model.outputs(snapshots.points())[felt, 3] - true[felt]) / true[felt]


def test_all_states_are_those_of_the_set_and_every_second_node_is_less_accurate(grid):
    """Tip and touch distance at every state, forces at most of them: few terms cannot follow every kink."""
    whole, half = (tabulated(grid_samples(grid, every), FEWER) for every in (1, 2))
    free = grid.answered("contact_force") == 0
    off = whole.outputs(grid.points())[free][:, :3] - grid.answered("tip")[free]
    assert np.abs(off).max() < 2e-4
    errors = relative_errors(whole, grid)
    assert len(errors) > 50 and np.median(errors) < 0.05
    assert np.median(relative_errors(half, grid)) > 2 * np.median(errors)


def test_a_state_that_failed_is_missing_and_its_cell_is_marked(grid):
    """Its numbers are not read, and the others say nearly what it would have been."""
    without, name = grid.only(grid.tasks), "contact-2-4"
    task = {key: np.array(one) for key, one in without.task(name).items()}
    task["converged"][3] = False
    for key in ("tip", "contact_force", "touch_distance", "tip_jacobian", "contact_force_jacobian"):
        task[key][3] = np.nan
    point, force = grid.task(name)["parameters"][3], grid.task(name)["contact_force"][3]
    without.__dict__["_tasks"] = without.__dict__["_tasks"] | {name: task}
    without.__dict__.pop("failures", None)
    answer = separate_grid(without, FEWER).evaluate(point)
    assert force > 0.5 and answer.contact_force == pytest.approx(force, rel=0.1)
    assert not answer.inside and separate_grid(grid, FEWER).evaluate(point).inside


def test_its_estimate_covers_its_states(grid):
    table = separate_grid(grid, FEWER)
    answers, true = table.evaluate(grid.points()), grid.answered("contact_force")
    felt = (true > 0.5) & answers.inside
    assert np.mean((np.abs(answers.contact_force - true) <= answers.error["contact_force"])[felt]) > 0.9
    assert table.provenance["states"] == grid.states


def test_sets_without_a_grid_are_refused(grid):
    free = grid.only(grid.tasks)
    free.description = replace(grid.description, parameters=grid.description.parameters[:-1])
    with pytest.raises(SnapshotError, match="must be a training set before a plane, on a grid"):
        grid_samples(free)
