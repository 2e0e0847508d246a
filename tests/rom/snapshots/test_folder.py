"""A set's folder: begun once, whoever of many does."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rom.snapshots.folder import create, set_aside_strangers
from rom.snapshots.snapshot_set import SnapshotError, SnapshotSet, read_description, read_task, task_file


def test_a_set_that_another_rank_begins_meanwhile_is_no_stranger(trained, tmp_path, monkeypatch):
    description, folder, listed = read_description(trained / "training"), tmp_path / "set", Path.iterdir

    def meanwhile(path):
        monkeypatch.setattr(Path, "iterdir", listed)
        create(folder, description)
        (folder / "body.npz").touch()
        return listed(path)

    monkeypatch.setattr(Path, "iterdir", meanwhile)
    create(folder, description)
    assert read_description(folder) == description


def test_another_set_and_a_foreign_folder_are_refused(trained, tmp_path):
    description = read_description(trained / "training")
    create(tmp_path / "set", description)
    with pytest.raises(SnapshotError, match="holds a set of another scene"):
        create(tmp_path / "set", replace(description, fingerprint="0"))
    (tmp_path / "thesis.tex").touch()
    with pytest.raises(SnapshotError, match="must be a snapshot set or an empty folder"):
        create(tmp_path, description)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("name", ["tip", "contact_force_jacobian", "parameters", "displacement"])
def test_a_snapshot_that_is_not_finite_is_refused_by_name_and_solved_again(trained, tmp_path, name, value):
    folder, task = tmp_path / "set", "scattered-3"
    shutil.copytree(trained / "training", folder)
    with np.load(task_file(folder, task)) as stored:
        arrays = dict(stored)
    k = int(np.flatnonzero(arrays["converged"])[-1])
    arrays[name][(k, *(0,) * (arrays[name].ndim - 1))] = value
    np.savez(task_file(folder, task), **arrays)
    told = rf"tasks/{task}.npz: {name} must be finite in a converged state, got nan or infinity in state {k}; delete"
    with pytest.raises(SnapshotError, match=told):
        if name == "displacement":  # is read by itself
            read_task(folder, task, (name,))
        SnapshotSet(folder).states_of("contact", "tip")
    if name != "displacement":
        assert set_aside_strangers(folder, read_description(folder)) == [task_file(folder, task)]


def test_what_has_not_converged_may_be_nan(trained):
    assert SnapshotSet(trained / "training").count("contact") > 100
