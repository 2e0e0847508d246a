"""A coarse mesh of a scene, on which states are cheap; the presets of scenes with a load choose one."""

import tomllib

import pytest
from farm import ROOT

from fingerfem.scene.presets import front
from fingerfem.scene.scene import Scene, SceneError

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
    assert scene.sampling.lines == 2 * best["lines"]
    assert scene.expected.quantity == "contact_force" and scene.expected.error == best["contact_force"]
    assert scene.expected.core_seconds == pytest.approx(best["core_seconds"])
    if best["coarse"] is None:
        assert scene.coarse is None
        return
    coarse = scene.on_coarse_mesh()
    assert (coarse.mesh.cells, coarse.mesh.order) == (best["coarse"]["cells"], best["coarse"]["order"])
    assert coarse.sampling.lines == scene.sampling.lines  # each of its states begins one on the fine mesh
    assert coarse.coarse is None and coarse.expected is None


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
