"""A grid takes the states of a coarser one, whose nodes are among its own."""

import subprocess
from pathlib import Path

import numpy as np
import pytest
from farm import ROOT, command, run

from rom.dataset.snapshot_set import SnapshotSet


@pytest.fixture(scope="module")
def planar(scene, tmp_path_factory) -> Path:
    """The finger of one tendon, which bends in a plane."""
    before, _, after = scene.read_text().partition('[[tendons]]\nname = "F2"')
    file = tmp_path_factory.mktemp("scene") / "planar.toml"
    file.write_text((before + after[after.index("[obstacle]") :]).replace("[0.0, 50.0]", "[0.0, 100.0]"))
    return file


@pytest.mark.long
def test_a_finer_grid_uses_the_states_of_a_coarser_one_again(scene, undisturbed, tmp_path):
    finer = tmp_path / "finer.toml"
    finer.write_text(scene.read_text().replace("tension_nodes = 4", "tension_nodes = 7"))
    reused = run(2, finer, tmp_path / "reused", "--reuse", str(undisturbed))
    fresh = run(2, finer, tmp_path / "fresh")
    ours, theirs = SnapshotSet(tmp_path / "reused"), SnapshotSet(tmp_path / "fresh")
    coarse = SnapshotSet(undisturbed)
    assert np.array_equal(ours.free("tip")[::2, ::2], coarse.free("tip"))
    assert np.array_equal(ours.contact("contact_force")[::2, ::2], coarse.contact("contact_force"), equal_nan=True)
    assert not ours.contact("iterations")[::2, ::2].any() and not ours.free("iterations")[::2, ::2].any()
    assert ours.contact("tip") == pytest.approx(theirs.contact("tip"), abs=1e-8, nan_ok=True)
    assert ours.contact("contact_force") == pytest.approx(theirs.contact("contact_force"), abs=1e-5, nan_ok=True)
    assert reused["newton_iterations"] < 0.9 * fresh["newton_iterations"]


@pytest.mark.long
def test_a_set_that_keeps_no_fields_is_used_again_too(planar, tmp_path):
    coarse, finer = tmp_path / "coarse.toml", tmp_path / "finer.toml"
    coarse.write_text(planar.read_text() + "store = []\n")
    finer.write_text(coarse.read_text().replace("_nodes = 4", "_nodes = 7"))
    run(2, coarse, tmp_path / "coarse")
    run(2, finer, tmp_path / "reused", "--reuse", str(tmp_path / "coarse"))
    run(2, finer, tmp_path / "fresh")
    ours, theirs = SnapshotSet(tmp_path / "reused"), SnapshotSet(tmp_path / "fresh")
    assert ours.contact("contact_force") == pytest.approx(theirs.contact("contact_force"), abs=1e-5, nan_ok=True)
    assert not ours.contact("iterations")[::2, ::2].any() and ours.contact("iterations").any()


def test_states_of_another_finger_are_not_used_again(scene, undisturbed, tmp_path):
    other = tmp_path / "other.toml"
    other.write_text(scene.read_text().replace("C1 = 1.9e6", "C1 = 2.0e6"))
    line = command(1, other, tmp_path / "set", "--reuse", str(undisturbed))
    done = subprocess.run(line, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 2 and "must be a set of the same scene to be used again" in done.stderr
    assert not (tmp_path / "set").exists()
