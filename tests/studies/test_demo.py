"""The demo's promises, read from the report it wrote."""

import json

import pytest

from rom import Surrogate


def test_every_held_force_is_within_three_percent_of_the_target_by_the_full_order_model(report):
    errors = [*report["grasp"]["force_errors"], *[hold["force_error"] for hold in report["holds"]]]
    assert len(errors) == 8
    assert max(errors) < 0.03


def test_the_grasp_found_the_object(report):
    grasp = report["grasp"]
    assert grasp["status"] == ["converged"] * 3
    assert max(grasp["distance_errors"]) < 1e-4
    assert grasp["centre"] == pytest.approx(grasp["true_centre"], abs=1e-4)


def test_every_full_order_state_of_training_and_check_converged(report):
    assert report["training"]["failed"] == report["heldout"]["failed"] == 0
    lines = 80 * 9  # of a free state and eight in contact; some do not touch, some have states between regimes
    assert 0.8 * lines < report["training"]["states"] < 1.3 * lines


def test_held_out_states_begin_near_by(report):
    """From rest they take 25 iterations."""
    assert report["heldout"]["newton_iterations"] < 12 * report["heldout"]["states"]


def test_reached_and_out_of_reach_are_told_apart(report):
    assert report["reach"]["status"] == "converged" and report["reach"]["verified_miss"] < 2e-4
    assert report["unreachable"]["status"] == "unreachable"


def test_the_report_shows_its_pictures_and_numbers(report, demo):
    page = (demo / "report.html").read_text()
    for picture in ("s11.png", "parity.png", "grasp.png"):
        assert f'src="{picture}"' in page
        assert (demo / picture).read_bytes().startswith(b"\x89PNG")
        assert (demo / picture).stat().st_size > 10_000
    assert f"{100 * report['errors']['contact_force']['median']:.2g}%" in page
    assert json.loads((demo / "report.json").read_text()) == report


def test_the_mesh_s_part_of_the_error_is_measured_and_estimated(report, demo):
    mesh, total = report["mesh_errors"], report["total_errors"]
    assert mesh["states"] == total["states"] == 24 and total["taught"]
    assert mesh["mesh"] == total["mesh"] == {"cells": [10, 5], "order": 2}
    # Of the draft mesh by far the larger part.
    assert mesh["contact_force"]["median"] > 10 * report["errors"]["contact_force"]["median"]
    assert total["contact_force"]["median"] == pytest.approx(mesh["contact_force"]["median"], rel=0.2)
    model = Surrogate.load(demo / "finger.h5")
    assert model.errors.mesh is not None
    assert model.accuracy["against_finer_mesh"]["contact_force"] == total["contact_force"]
