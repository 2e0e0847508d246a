"""A coarse mesh of a scene, on which states are cheap; the presets of scenes with a load choose one."""

import subprocess
import sys
import tomllib

import pytest
from farm import ROOT

from fingerfem.scene.presets import front
from fingerfem.scene.scene import Scene, SceneError
from rom.dataset.snapshot_set import SnapshotSet
from studies.sets import as_toml

RODS = front()


@pytest.fixture
def pressed():
    """The demo's finger, which anything may press on, without mesh and lines."""
    found = tomllib.loads((ROOT / "scenes" / "demo" / "fine.toml").read_text())
    return {key: value for key, value in found.items() if key not in ("mesh", "sampling", "coarse")}


@pytest.mark.parametrize("one", RODS)
def test_a_scene_with_a_load_gets_the_meshes_that_were_measured(pressed, one):
    scene = Scene.model_validate(pressed | {"accuracy": f"{100.0001 * one['contact_force']:.12f} %"})
    best = min(
        (other for other in RODS if other["contact_force"] <= one["contact_force"] * 1.000001),
        key=lambda other: other["core_seconds"],
    )
    assert (scene.mesh.cells, scene.mesh.order) == (best["cells"], best["order"])
    assert scene.expected.quantity == "contact_force" and scene.expected.error == best["contact_force"]
    assert scene.expected.core_seconds == pytest.approx(best["core_seconds"])
    if best["coarse"] is None:
        assert scene.coarse is None
        return
    coarse = scene.on_coarse_mesh()
    assert (coarse.mesh.cells, coarse.mesh.order) == (best["coarse"]["cells"], best["coarse"]["order"])
    assert coarse.sampling.lines == scene.sampling.lines  # each of its states begins one on the fine mesh
    assert coarse.coarse is None and coarse.expected is None


def test_presets_of_scenes_with_a_load_go_from_cheap_to_accurate(pressed):
    found = [Scene.model_validate(pressed | {"preset": name}).expected for name in ("draft", "standard", "fine")]
    assert [one.core_seconds for one in found] == sorted({one.core_seconds for one in found})
    assert [one.error for one in found] == sorted({one.error for one in found}, reverse=True)


def test_a_coarse_mesh_is_no_other_finger_and_its_own_scene_is_one(pressed):
    plain = Scene.model_validate(pressed | {"mesh": {"cells": [20, 5]}, "sampling": {"store": []}})
    both = Scene.model_validate(plain.model_dump() | {"coarse": {"cells": [10, 5], "lines": 7}})
    assert both.fingerprint() == plain.fingerprint() and "coarse" not in plain.model_dump()
    coarse = both.on_coarse_mesh()
    assert coarse.fingerprint() != plain.fingerprint()
    assert coarse.sampling.lines == 7 and coarse.sampling.store == []
    assert Scene.model_validate(coarse.model_dump()) == coarse
    with pytest.raises(SceneError, match="coarse must be a table"):
        plain.on_coarse_mesh()


def test_a_coarse_mesh_that_does_not_fit_is_refused_as_such(pressed):
    with pytest.raises(ValueError, match=r"coarse\.cells\[0\] must leave no cell"):
        Scene.model_validate(pressed | {"mesh": {"cells": [20, 5]}, "coarse": {"cells": [4, 5]}})


def test_a_mesh_of_two_is_not_chosen_and_given(pressed):
    with pytest.raises(ValueError, match=r"coarse\.cells must be left out where preset chooses it"):
        Scene.model_validate(pressed | {"preset": "standard", "coarse": {"cells": [10, 5]}})


@pytest.mark.long
def test_two_commands_solve_both_meshes_of_one_scene(pressed, tmp_path):
    file = tmp_path / "scene.toml"
    meshes = {"mesh": {"cells": [14, 5]}, "coarse": {"cells": [10, 5], "lines": 5}, "sampling": {"lines": 4}}
    file.write_text(as_toml(pressed | meshes))
    words = [sys.executable, "-m", "fingerfem", "snapshots", str(file)]
    for folder, options in (("coarse", ["--coarse"]), ("fine", ["--near", str(tmp_path / "coarse")])):
        subprocess.run([*words, str(tmp_path / folder), *options], cwd=ROOT, check=True, capture_output=True)
    coarse, fine = SnapshotSet(tmp_path / "coarse"), SnapshotSet(tmp_path / "fine")
    assert len(coarse.tasks) == 5 and len(fine.tasks) == 4 and not coarse.failures and not fine.failures
    assert coarse.description.scene["mesh"]["cells"] == [10, 5]
    assert fine.iterations / fine.states < coarse.iterations / coarse.states
