"""Lines that a set still needs where contact regimes have few states, and states that a line needs between regimes."""

import numpy as np
import pytest
from farm import run

from rom.refinement.regime_lines import ENOUGH_STATES, MOST_LINES, between_regimes
from rom.snapshots.snapshot_set import SnapshotSet


@pytest.fixture(scope="module")
def training(spatial, tmp_path_factory) -> SnapshotSet:
    """A set on a grid."""
    folder = tmp_path_factory.mktemp("grid")
    file, text = folder / "grid.toml", spatial.read_text()
    file.write_text(
        text.replace("tension_nodes = 4", "tension_nodes = 7").replace("contact_nodes = 4", "contact_nodes = 8")
    )
    run(2, file, folder / "set")
    return SnapshotSet(folder / "set")


def test_every_small_regime_has_got_lines_half_way_between_those_of_the_grid(training):
    (planned, last) = training.plan.rounds
    assert planned.lines and not last.lines and last.finest
    contact = [line for line in training.description.lines.values() if line.kind == "contact"]
    assert len(planned.lines) <= MOST_LINES * len(contact)
    upper = [parameter["upper"] for parameter in training.description.parameters[:-1]]
    for line in planned.lines.values():
        assert line.kind == "scattered" and training.description.has(line)
        assert all(0 <= tension <= most for tension, most in zip(line.tensions, upper, strict=True))


def test_they_add_states_to_the_regimes_that_had_few(training):
    grid, all_of_them = {}, {}
    for task, line in training.plan.lines.items():
        stored = training.task(task)
        for code in stored["regime"][stored["converged"] & (stored["contact_force"] > 0)]:
            key = tuple(code.tolist())
            all_of_them[key] = all_of_them.get(key, 0) + 1
            if line.kind == "contact":
                grid[key] = grid.get(key, 0) + 1
    small = [key for key, count in grid.items() if count < ENOUGH_STATES]
    assert len(small) >= 3
    assert sum(all_of_them[key] > grid[key] for key in small) >= 0.75 * len(small)


def test_states_between_regimes_find_their_ends(trained):
    """No two states beside each other on a line differ in regime and are far apart."""
    training, apart = SnapshotSet(trained / "training"), []
    for task in training.description.lines:
        stored = training.task(task)
        touching = stored["contact_force"] > 0
        distances, codes = stored["parameters"][touching, -1], stored["regime"][touching]
        order = np.argsort(-distances)
        way = stored["touch_distance"][0] - 0.001
        for near, far in zip(order[1:], order[:-1], strict=True):
            if not np.array_equal(codes[near], codes[far]):
                apart.append((distances[far] - distances[near]) / way)
    assert len(apart) > 20 and np.max(apart) <= 0.04 + 1e-9


def test_a_set_that_had_its_round_needs_no_other(training):
    again = between_regimes(training)
    assert not again.lines and again.finest
