"""A set's folder: begun once, whoever of many does, and what is read of it."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rom.dataset.folder import create, set_aside_strangers
from rom.dataset.snapshot_set import SnapshotError, SnapshotSet, read_description, read_task, task_file, write_task


def test_a_set_that_another_rank_begins_meanwhile_is_no_stranger(grid_set, tmp_path, monkeypatch):
    description, folder, listed = read_description(grid_set), tmp_path / "set", Path.iterdir

    def meanwhile(path):
        monkeypatch.setattr(Path, "iterdir", listed)
        create(folder, description)
        (folder / "body.npz").touch()
        return listed(path)

    monkeypatch.setattr(Path, "iterdir", meanwhile)
    create(folder, description)
    assert read_description(folder) == description


def test_another_set_and_a_foreign_folder_are_refused(grid_set, tmp_path):
    description = read_description(grid_set)
    with pytest.raises(SnapshotError, match="holds a set of another scene"):
        create(grid_set, replace(description, fingerprint="0"))
    with pytest.raises(SnapshotError, match="holds a set of other contact nodes"):
        create(grid_set, replace(description, contact_nodes=[0.0, 1.0]))
    (tmp_path / "thesis.tex").touch()
    with pytest.raises(SnapshotError, match="must be a snapshot set or an empty folder"):
        create(tmp_path, description)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("name", ["tip", "contact_force_jacobian", "parameters", "displacement"])
def test_a_snapshot_that_is_not_finite_is_refused_by_name_and_solved_again(grid_set, name, value):
    task = "contact-0-3"
    arrays = read_task(grid_set, task)
    arrays[name][(2, *(0,) * (arrays[name].ndim - 1))] = value
    write_task(grid_set, task, "drawn", arrays)
    reason = rf"tasks/{task}.npz: {name} must be finite in a converged state, got nan or infinity in state 2; delete"
    with pytest.raises(SnapshotError, match=reason):
        if name == "displacement":  # is read by itself
            read_task(grid_set, task, (name,))
        SnapshotSet(grid_set).states_of("contact", "tip")
    if name != "displacement":
        assert set_aside_strangers(grid_set, read_description(grid_set)) == [task_file(grid_set, task)]


def test_a_grid_has_every_state_at_its_place_and_nan_where_there_is_no_answer(grid_set):
    arrays = read_task(grid_set, "contact-0-2")
    arrays["converged"][1] = False
    for name in ("tip", "contact_force", "displacement"):
        arrays[name][1] = np.nan
    write_task(grid_set, "contact-0-2", "drawn", arrays)
    snapshots = SnapshotSet(grid_set)
    force = snapshots.contact("contact_force")
    assert force.shape == (4, 4) and snapshots.contact("displacement").shape == (4, 4, 2, 3)
    assert np.isnan(force[0]).all()  # the finger does not reach the plane
    assert np.array_equal(force[3], read_task(grid_set, "contact-0-3")["contact_force"])
    assert np.isnan(force[2, 1]) and not snapshots.contact("converged")[2, 1]
    assert np.array_equal(snapshots.free("tip"), read_task(grid_set, "free-0")["tip"])
    assert [task for task, *_ in snapshots.failures] == ["contact-0-2"]
    assert len(snapshots.states_of("contact", "tip")) == 3 * 4 - 1 and len(snapshots.states_of("free", "tip")) == 4
    assert len(snapshots.answered("tip")) == snapshots.states - 1 == 15


def rewrite(folder: Path, **changes) -> None:
    file = folder / "set.json"
    file.write_text(json.dumps(json.loads(file.read_text()) | changes))


def test_of_the_former_format_held_out_sets_and_those_with_a_load_are_read(grid_set):
    for changes in ({"random": [[0.1, 0.02]]}, {"wrenches": [[[0.0] * 6]], "scattered": [[0.3]]}):
        rewrite(grid_set, format=7, onset_nodes=[0.0, 1.0], **changes)
        found = read_description(grid_set)
        assert [getattr(found, name) for name in changes] == list(changes.values())
        rewrite(grid_set, **{key: [] for key in changes})
    with pytest.raises(SnapshotError, match="must be a set of format 8, got 7"):
        read_description(grid_set)
