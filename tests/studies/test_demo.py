"""The demo's promises, read from the report it wrote; its meshes are coarse here."""

import json
from itertools import product

import numpy as np
import pytest
from farm import ROOT

from fingerfem import FingerModel, load_scene
from fingerfem.scene.scene import Scene
from rom import SegmentMap, TouchedSegment
from rom.table import percent


def test_every_held_force_is_near_the_target_by_the_full_order_model(report):
    """Without feedback it is off by what a few states on a coarse mesh teach."""
    assert len(report["grasp"]["force_errors"]) == 3 and max(report["grasp"]["force_errors"]) < 0.005
    assert len(report["holds"]) == 5
    assert max(hold["force_error"] for hold in report["holds"]) < 0.06


def test_the_grasp_found_the_object(report):
    grasp = report["grasp"]
    assert grasp["status"] == ["converged"] * 3
    assert max(grasp["distance_errors"]) < 2e-4
    assert grasp["centre"] == pytest.approx(grasp["true_centre"], abs=2e-4)


def test_every_full_order_state_of_training_and_check_converged(report):
    parts = [report[name] for name in ("coarse", "fine", "heldout")]
    assert [part["failed"] for part in parts] == [0, 0, 0]
    assert [part["states"] for part in parts] == [24 * 5, 8 * 5, 8 * 4]


def test_fine_states_begin_at_coarse_ones(report):
    """From rest they take twice the factorisations."""
    per_state = {name: report[name]["newton_iterations"] / report[name]["states"] for name in ("coarse", "fine")}
    assert per_state["fine"] < 0.6 * per_state["coarse"]


def test_few_fine_states_remove_most_of_what_the_coarse_mesh_errs_by(report):
    coarse, both = (report["errors"][name] for name in ("coarse", "both"))
    assert both["states"] == coarse["states"] == 32
    for quantity in ("tip", "touch_distance", "contact_force"):
        assert both[quantity]["median"] < 0.3 * coarse[quantity]["median"], quantity
    assert both["contact_force"]["coverage"] >= 0.8
    assert both["touch"]["wrong"] == 0


def test_reached_and_out_of_reach_are_told_apart(report):
    assert report["reach"]["status"] == "converged" and report["reach"]["verified_miss"] < 5e-4
    assert report["unreachable"]["status"] == "unreachable"


def test_the_report_shows_its_pictures_and_numbers(report, demo):
    page = (demo / "report.html").read_text()
    for picture in ("s11.png", "parity.png", "grasp.png"):
        assert f'src="{picture}"' in page
        assert (demo / picture).read_bytes().startswith(b"\x89PNG")
        assert (demo / picture).stat().st_size > 10_000
    assert percent(report["errors"]["both"]["contact_force"]["median"]) in page
    assert json.loads((demo / "report.json").read_text()) == report
    assert 'href="finger.html"' in page and (demo / "finger.html").read_text().startswith("<!doctype html>")


def test_the_model_says_what_it_was_made_of(report, demo):
    model = SegmentMap.load(demo / "finger.h5")
    assert model.scene["mesh"]["cells"] == report["meshes"]["fine"]["cells"]
    assert model.provenance["states"] == 40 and model.provenance["coarse"]["states"] == 120
    assert model.accuracy["contact_force"] == report["errors"]["both"]["contact_force"]


HALF = np.array([0.0005, 0.005, 0.005])  # lengths of the plate [m]


def test_the_touch_distance_is_the_rubber_s_where_that_touches_first(report, demo):
    """Tendon F2 bends the finger beside the plane: the plate is 0.4 mm farther from it than the bulging rubber."""
    model, tensions = TouchedSegment.load(demo / "finger.h5"), [0.4, 88.0]
    scene = load_scene(ROOT / "scenes" / "demo" / "plane.toml").model_dump(exclude_none=True)
    true = FingerModel(Scene(**scene | {"mesh": report["meshes"]["fine"]})).solve(tensions, sensitivities=False)
    answer = model.evaluate([*tensions, 0.02])
    placed = model.rod.place(tensions, np.zeros((1, 6)))
    corners = placed.centres[0] + np.array(list(product(*zip(-HALF, HALF, strict=True)))) @ placed.rotations[0].T
    assert true.touch_distance > corners[:, 1].max() - HALF[1] + 2e-4
    assert model.outputs([[*tensions, 0.02]])[0, 4] == answer.touch_distance
    assert abs(answer.touch_distance - true.touch_distance) < min(answer.error["touch_distance"], 1e-4)
