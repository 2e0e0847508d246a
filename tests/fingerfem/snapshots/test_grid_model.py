"""The paper's method on full-order states: a grid of them, separated by alternating directions, as a table."""

from dataclasses import replace

import numpy as np
import pytest
from farm import run

from rom.build import separate_grid
from rom.separated.alternating_directions import EnrichmentOptions
from rom.separated.grid_model import truth_of
from rom.separated.grid_source import GridSource
from rom.snapshots.snapshot_set import SnapshotError, SnapshotSet


@pytest.fixture(scope="module")
def grid(scene, tmp_path_factory) -> SnapshotSet:
    """Seven nodes an axis of a coarse finger."""
    folder = tmp_path_factory.mktemp("grid")
    file = folder / "grid.toml"
    file.write_text(scene.read_text().replace("nodes = 4", "nodes = 7"))
    run(2, file, folder / "set")
    return SnapshotSet(folder / "set")


@pytest.fixture(scope="module")
def whole(grid) -> GridSource:
    return GridSource(grid)


def relative_errors(source: GridSource, truth) -> np.ndarray:
    """Of contact forces above 0.5 N at states."""
    felt = truth.out[:, 3] > 0.5
    found = source.sampled(truth.points).out[felt, 3]
    return np.abs(found - truth.out[felt, 3]) / truth.out[felt, 3]


def test_all_states_are_those_of_the_set(whole):
    """Tip and touch distance at every state, forces at most of them: few terms cannot follow every kink."""
    truth = truth_of(whole.snapshots, False, False)
    found = whole.sampled(truth.points).out
    free = truth.out[:, 3] == 0
    assert np.abs(found - truth.out)[free][:, :3].max() < 2e-4
    errors = relative_errors(whole, truth)
    assert len(errors) > 50 and np.median(errors) < 0.05


def test_every_second_node_is_less_accurate(grid, whole):
    half = relative_errors(GridSource(grid, every=2), truth_of(grid, False, False))
    assert np.median(half) > 2 * np.median(relative_errors(whole, truth_of(grid, False, False)))


def test_derivatives_are_those_of_the_values(whole):
    truth = truth_of(whole.snapshots, False, False)
    points = truth.points[truth.out[:, 3] > 0.5][::7]
    jacobian = whole.sampled(points).jacobian
    for k, step in enumerate((1e-4, 1e-4, 1e-8)):
        ends = [whole.sampled(points + sign * step * np.eye(3)[k]).out for sign in (1, -1)]
        slopes = (ends[0] - ends[1]) / (2 * step)
        np.testing.assert_allclose(jacobian[..., k], slopes, atol=1e-4 * np.abs(slopes).max(), rtol=1e-3)


def test_a_state_that_failed_is_missing(grid, whole):
    """Its numbers are not read, and the others say nearly what it would have been."""
    without = grid.only(grid.tasks)
    name = "contact-2-4"
    task = {key: np.array(one) for key, one in without.task(name).items()}
    task["converged"][3] = False
    for key in ("tip", "contact_force", "touch_distance", "tip_jacobian", "contact_force_jacobian"):
        task[key][3] = np.nan
    point, force = grid.task(name)["parameters"][3], grid.task(name)["contact_force"][3]
    without.__dict__["_tasks"][name] = task
    found = GridSource(without).sampled(point[None]).out[0, 3]
    assert force > 0.5 and found == pytest.approx(force, rel=0.1)


def test_the_table_is_its_source_and_says_by_how_much_it_may_differ(grid, whole):
    table = separate_grid(grid, 12, EnrichmentOptions(tolerance=1e-5, terms=60))
    truth = truth_of(whole.snapshots, False, False)
    answers = table.evaluate(truth.points)
    own = whole.sampled(truth.points).out[:, 3]
    felt = (truth.out[:, 3] > 0.5) & answers.inside
    assert np.median(np.abs(answers.contact_force - own)[felt] / own[felt]) < 0.05
    assert np.mean((np.abs(answers.contact_force - truth.out[:, 3]) <= answers.error["contact_force"])[felt]) > 0.9
    assert table.provenance["states"] == grid.states


def test_sets_without_a_grid_are_refused(grid):
    free = grid.only(grid.tasks)
    free.description = replace(grid.description, parameters=grid.description.parameters[:-1])
    with pytest.raises(SnapshotError, match="must be a training set before a plane, on a grid"):
        GridSource(free)
