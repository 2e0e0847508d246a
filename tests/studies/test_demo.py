"""The demo's promises, read from the report it wrote; its meshes are coarse here."""

import json
from itertools import product

import numpy as np
import pytest
from farm import ROOT

from fingerfem import FingerModel, load_scene
from fingerfem.scene.scene import Scene
from rom import Rod, TouchedSegment
from rom.console.table import percent


def test_every_held_force_is_near_the_target_by_the_full_order_model(report):
    """Without feedback it is off by the error of the elements: the fingers are on the trained mesh here."""
    assert len(report["grasp"]["force_errors"]) == 3 and max(report["grasp"]["force_errors"]) < 0.005
    assert len(report["holds"]) == 5
    assert max(hold["force_error"] for hold in report["holds"]) < 0.002


def test_the_grasp_found_the_object(report):
    grasp = report["grasp"]
    assert grasp["status"] == ["converged"] * 3
    assert max(grasp["distance_errors"]) < 2e-4
    assert grasp["centre"] == pytest.approx(grasp["true_centre"], abs=2e-4)


def test_every_full_order_state_of_training_and_check_converged(report):
    parts = [report[name] for name in ("coarse", "fine", "heldout")]
    assert [part["failed"] for part in parts] == [0, 0, 0]
    assert [part["states"] for part in parts] == [12 * 5, 12 * 5, 4 * 4]


def test_fine_states_begin_at_coarse_ones(report):
    """From rest they take twice the factorisations."""
    per_state = {name: report[name]["newton_iterations"] / report[name]["states"] for name in ("coarse", "fine")}
    assert per_state["fine"] < 0.6 * per_state["coarse"]


def test_the_finger_agrees_with_held_out_states_within_its_estimates(report):
    """States in contact with a plane, of which the elements have seen none."""
    errors = report["errors"]
    assert errors["states"] == 16 and errors["marked"] <= 1
    for quantity in ("tip", "touch_distance", "contact_force"):
        assert errors[quantity]["p95"] < 0.002 and errors[quantity]["coverage"] >= 0.9, quantity
    assert errors["touch"]["wrong"] == 0


def test_left_out_lines_say_what_held_out_states_show(report):
    left_out, held_out = report["left_out"]["contact_force"], report["errors"]["contact_force"]
    assert 0.1 * left_out["p95"] < held_out["p95"] < 2 * left_out["p95"]


def test_reached_and_out_of_reach_are_distinguished(report):
    assert report["reach"]["status"] == "converged" and report["reach"]["verified_miss"] < 5e-4
    assert report["unreachable"]["status"] == "unreachable"


def test_the_report_shows_its_pictures_and_numbers(report, demo):
    page = (demo / "report.html").read_text()
    for picture in ("s11.png", "parity.png", "grasp.png"):
        assert f'src="{picture}"' in page
        assert (demo / picture).read_bytes().startswith(b"\x89PNG")
        assert (demo / picture).stat().st_size > 10_000
    assert percent(report["errors"]["contact_force"]["median"]) in page
    assert json.loads((demo / "report.json").read_text()) == report
    assert 'href="finger.html"' in page and (demo / "finger.html").read_text().startswith("<!doctype html>")


def test_the_model_file_holds_its_elements_origin_and_accuracy(report, demo):
    finger = Rod.load(demo / "finger.h5")
    assert finger.scene["mesh"]["cells"] == report["meshes"]["fine"]["cells"]
    assert finger.elements.provenance["states"] == 60
    assert [piece.kind for piece in reversed(finger.pieces[0])] == report["elements"]
    assert finger.accuracy["contact_force"] == report["errors"]["contact_force"]


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
