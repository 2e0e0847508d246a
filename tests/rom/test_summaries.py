"""Models as plain data: strict JSON, lengths that add up, and counts that are those of the sets."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

import rom
from rom.summaries import finer_origin, origin, rod_summary, separated_summary


def snapshots(states: int, failed: int):
    """Attributes that a summary reads of a set."""
    description = SimpleNamespace(
        fingerprint="f",
        versions={"v": 1},
        held_out_id="random-1",
        scene={"mesh": {"cells": [9, 5], "order": 2, "x": 0}},
    )
    return SimpleNamespace(description=description, states=states, failures=["why"] * failed)


def strict(summary: dict) -> dict:
    return json.loads(json.dumps(summary, allow_nan=False))


def test_a_finger_s_pieces_are_as_long_as_its_segments_and_its_terms_those_of_its_laws(rod):
    found = strict(rod_summary(rod))
    half = rod.scene["geometry"]["plate"] / 2
    lengths = [sum(piece["length_m"] for piece in one) + half for one in found["segments"]]
    assert lengths == pytest.approx(rod.scene["geometry"]["segments"])
    products = {kind: len(np.unique(law.polynomial.powers, axis=0)) for kind, law in rod.elements.laws.items()}
    assert found["terms"] == products and [one["name"] for one in found["parameters"]] == rod.names
    assert found["accuracy"]["states"] > 0 and found["trained_on"] == found["scene"]


def test_a_finger_of_another_size_is_trained_on_the_same_and_has_errors_of_its_size(rod):
    scene = json.loads(json.dumps(rod.scene))
    scene["geometry"] |= {name: 2 * scene["geometry"][name] for name in ("side", "plate")} | {"segments": [0.1]}
    for tendon in scene["tendons"]:
        tendon |= {"offset": [2 * one for one in tendon["offset"]], "tension": [0.0, 400.0]}
    one, other = rod_summary(rod), rod_summary(rod.assembled(scene | {"name": "large"}))
    assert (other["size"], other["modulus"]) == pytest.approx((2.0, 1.0)) and one["size"] == 1.0
    assert (other["scene"], other["trained_on"]) == ("large", one["scene"])
    assert other["place_error_m"] == pytest.approx(2 * one["place_error_m"])
    assert other["accuracy"] == "not measured: build with --held-out"


def test_states_that_failed_are_counted_apart():
    assert origin(snapshots(7, 2)) == {"fingerprint": "f", "versions": {"v": 1}, "states": 7, "failed": 2}
    assert finer_origin(snapshots(7, 2)) == {"set": "random-1", "states": 5, "cells": [9, 5], "order": 2}


def test_a_separated_model_says_the_last_of_its_errors_and_whether_it_has_a_field():
    forms = [SimpleNamespace(errors=np.array([0.5, last])) for last in (0.1, 0.2)]
    parameters = rom.load().parameters
    model = SimpleNamespace(
        scene={"name": "s"}, parameters=parameters, terms={"free": 2}, free=forms[0], contact=forms[1], nodes=None
    )
    model.accuracy, model.provenance = {}, {}
    found = strict(separated_summary(model))
    assert found["separation_error"] == {"free": 0.1, "contact": 0.2}
    assert found["nodes"] == "without the displacement field" and "not measured" in found["accuracy"]
    model.nodes = np.zeros((11, 3))
    assert strict(separated_summary(model))["nodes"] == 11
    assert [one["upper"] for one in found["parameters"]] == [one.upper for one in parameters]
