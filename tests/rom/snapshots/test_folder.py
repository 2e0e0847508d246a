"""A set's folder: begun once, whoever of many does."""

from dataclasses import replace
from pathlib import Path

import pytest

from rom.snapshots.folder import create
from rom.snapshots.snapshot_set import SnapshotError, read_description


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
