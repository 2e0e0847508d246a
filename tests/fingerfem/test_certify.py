"""Comparison of a model's answers with the full-order model."""

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest
from farm import ROOT
from terminal import ran

from fingerfem import load_scene
from fingerfem.certify import Certificate, Certifier, corners_outside, full_order_scene
from fingerfem.scene.scene import Scene
from rom import SeparatedModel, TouchedSegment
from rom.build import separate_grid
from rom.dataset.snapshot_set import SnapshotSet


@pytest.fixture(scope="module")
def grid(undisturbed) -> SnapshotSet:
    return SnapshotSet(undisturbed)


@pytest.fixture(scope="module")
def table(grid, tmp_path_factory) -> Path:
    """The file of a table of full-order states."""
    file = tmp_path_factory.mktemp("table") / "table.h5"
    separate_grid(grid).save(file)
    return file


def test_the_truth_of_a_table_is_its_state_and_the_answer_its_own(grid, table):
    model = SeparatedModel.load(table)
    certifier, point = Certifier(model), grid.contact("parameters")[2, 2, 3]
    found = certifier.certify(point[:-1], float(point[-1]))
    assert found.contact_force == pytest.approx(grid.contact("contact_force")[2, 2, 3], abs=1e-4)
    assert found.tip == pytest.approx(grid.contact("tip")[2, 2, 3], abs=1e-8)
    assert found.errors["contact_force"] == abs(model.evaluate(point).contact_force - found.contact_force)
    assert found.factorisations > 2


@pytest.mark.long
def test_a_free_finger_is_certified_too(grid, table):
    found = Certifier(SeparatedModel.load(table)).certify(grid.free("parameters")[2, 2, :-1])
    assert found.contact_force is None and found.errors.keys() == {"tip"}
    assert found.tip == pytest.approx(grid.free("tip")[2, 2], abs=1e-8)


@pytest.mark.long
def test_a_finger_of_elements_is_compared_on_the_mesh_that_corrected_it():
    """On the mesh of its training a corrected finger would seem off by what these meshes differ by."""
    bundled = TouchedSegment.load()
    found, finer = full_order_scene(bundled), bundled.rod.elements.provenance["corrected_by"]
    assert found["mesh"]["cells"] == finer["cells"] == [32, 7] and found["mesh"]["order"] == finer["order"]
    assert bundled.scene["mesh"]["cells"] == [24, 6] and "load" not in found


def test_corners_of_straight_cells_are_outside_a_circle_by_the_share_that_keeps_its_area():
    table = tomllib.loads((ROOT / "scenes" / "round.toml").read_text())
    mesh = table["mesh"]
    scenes = [Scene.model_validate(table | {"mesh": mesh | {"order": order}}) for order in (1, 2)]
    radius = scenes[0].geometry.side / 2
    straight, curved = map(corners_outside, scenes)
    assert curved == 0 and 0.002 * radius < straight < 0.02 * radius
    assert corners_outside(load_scene(ROOT / "scenes" / "draft.toml")) == 0
    compared = {"answer": None, "tip": np.zeros(3), "contact_force": None, "factorisations": 0}
    (mark,) = Certificate(**compared, corners=straight).marks
    assert f"{1e3 * straight:.2g} mm outside the circle" in mark and not Certificate(**compared).marks


def test_a_longer_finger_has_as_long_cells():
    """Cells as long as its trained finger's would be coarse."""
    bundled = TouchedSegment.load()
    geometry = bundled.scene["geometry"] | {"segments": [0.1, 0.06]}
    tendons = [tendon | {"segment": 2} for tendon in bundled.scene["tendons"]]
    rod = bundled.rod.assembled(bundled.scene | {"geometry": geometry, "tendons": tendons})
    assert full_order_scene(TouchedSegment(rod=rod, obstacle=bundled.obstacle))["mesh"]["cells"] == [64, 7]


def test_the_command_prints_both_answers_and_refuses_in_one_line(grid, table):
    tensions = np.round(grid.free("parameters")[2, 2, :-1], 3)
    point = [f"F1={tensions[0]}", f"F2={tensions[1]}", "d=0.010"]
    done = ran("fingerfem", "certify", table, *point, "--json")
    found = json.loads(done.stdout)
    force, tip = found["contact_force"], found["tip"]
    assert force["error"] == pytest.approx(abs(force["answer"] - force["full_order"]))
    estimated = all(one["error"] <= one["estimated_error"] for one in (force, tip))
    assert found["covered"] == (found["inside"] and estimated)
    assert done.returncode == (0 if found["covered"] else 3)
    shown = ran("fingerfem", "certify", table, *point)
    assert shown.returncode == done.returncode and "estimated_error" in shown.stdout
    refused = ran("fingerfem", "certify", table, "F1=500")
    assert refused.returncode == 2 and "F1 must lie in [0, 50] N" in refused.stderr
    assert len(refused.stderr.splitlines()) == 1


def test_a_table_of_a_finger_is_refused(table):
    model = SeparatedModel.load(table)
    model.provenance["specialised_from"] = "a finger"
    with pytest.raises(ValueError, match="model must be the finger itself to be certified, got a table of one"):
        Certifier(model)
