"""Every refusal has a reason: a sentence that names the argument, its value and its range."""

import json

import numpy as np
import pytest
from terminal import ran

import rom
from control import Gripper, SimulatedPlant

NAN = float("nan")


REFUSED = {
    "a plane in millimetres": (lambda one: one.hold(1.0, 10), "distance must be from 0 to 0.05 m, got 10 m"),
    "a plane too near": (lambda one: one.hold(1.0, -0.001), "distance must be from 0 to 0.05 m, got -0.001 m"),
    "no plane": (lambda one: one.hold(1.0), "distance must be from 0 to 0.05 m, got nan m"),
    "no force": (lambda one: one.hold(0.0, 0.01), "contact_force must be finite and above 0 N, got 0 N"),
    "a force that pulls": (lambda one: one.hold(-2.0, 0.01), "contact_force must be finite and above 0 N, got -2 N"),
    "a start": (lambda one: one.hold(1.0, 0.01, start=[NAN, 0]), "start must be finite in N, got [nan, 0] N"),
    "reach before it": (
        lambda one: one.reach(one.rest, 10.0),
        "distance must be from 0 to 0.05 m, got 10 m",
    ),
    "a point": (lambda one: one.reach([NAN, 0, 0]), "point must be three numbers within 1e+06 m, got [nan, 0, 0]"),
    "a point far away": (lambda one: one.reach([1e200, 0, 0]), "point must be three numbers within 1e+06 m, got [1e+2"),
    "two numbers": (lambda one: one.reach([0.0, 0.1]), "point must be three numbers within 1e+06 m, got [0, 0.1]"),
    "reach from": (lambda one: one.reach(one.rest, start=[np.inf, 0]), "start must be finite in N, got [inf, 0] N"),
    "follow": (lambda one: one.follow([[NAN] * 3], 0.01)[0], "point must be three numbers within 1e+06 m"),
    "follow before it": (
        lambda one: one.follow([one.rest], 0.01, 10.0)[0],
        "distance must be from 0 to 0.05 m, got 10 m",
    ),
    "felt at": (
        lambda one: one.locate([500.0, 0.0], 1.0),
        "tensions must be from [0, 0] to [100, 100] N, got [500, 0] N",
    ),
    "felt": (lambda one: one.locate([50.0, 0.0], 0.0), "contact_force must be finite and above 0 N, got [0] N"),
    "readings": (
        lambda one: one.locate([50.0], 1.0),
        "tensions must be 2 for each of 1 contact forces, got shape (1,)",
    ),
    "noise": (lambda one: one.locate([50.0, 0.0], 1.0, noise=-1.0), "noise must be from 0 to 1.79769e+308 N, got -1 N"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_refusal_names_argument_value_and_range(rod_finger, name):
    ask, reason = REFUSED[name]
    motion = ask(rod_finger)
    assert motion.status == "out_of_domain" and motion.reason.startswith(reason)
    assert motion.as_json()["reason"] == motion.reason and motion.reason in motion.tables()


def test_an_answer_has_a_reason_if_and_only_if_it_is_not_converged(rod_finger):
    random, statuses = np.random.default_rng(0), set()
    for _ in range(150):
        force, d = 10 ** random.uniform(-2, 2), random.uniform(-0.002, 0.052)
        for motion in (
            rod_finger.hold(force, d),
            rod_finger.reach(rod_finger.rest + random.uniform(-0.03, 0.03, 3), d),
            rod_finger.locate(random.uniform(0, 100, 2), force),
        ):
            statuses.add(motion.status)
            assert bool(motion.reason) == (not motion.converged) and "\n" not in motion.reason
            if motion.reason:
                assert any(name in motion.reason for name in ("contact_force", "distance", "point"))
                assert "must be" in motion.reason or "was not met by" in motion.reason
    assert {"converged", "unreachable", "out_of_domain"} <= statuses


def test_what_is_out_of_reach_is_named_with_what_misses_it(rod_finger):
    motion = rod_finger.hold(500.0, 0.005)
    assert motion.reason.startswith("contact_force 500 N at distance 0.005 m must be met ")
    far = rod_finger.reach([0.0, 0.2, 0.0])
    miss = f"the nearest of which miss it by {far.residual:.3g} m"
    assert far.reason == f"point [0, 0.2, 0] m must be met by tensions from [0, 0] to [100, 100] N, {miss}"


def test_a_grasp_of_nothing_says_of_every_finger_why(table):
    gripper = Gripper(table)
    grasp = gripper.grasp(1.0, [SimulatedPlant(table, np.inf) for _ in range(3)])
    assert grasp.status == ["no_contact"] * 3
    expected = "contact must be felt above 0.05 N at lead tensions up to 100 N, nothing was"
    assert grasp.reason == [expected] * 3 and grasp.as_json()["reason"] == grasp.reason
    held = gripper.grasp(1.0, [SimulatedPlant(table, 0.01) for _ in range(3)])
    assert held.converged and held.reason == [""] * 3


def test_the_command_prints_the_reason(table_file):
    words = ["control", "hold", table_file, "--distance", "0.005", "--contact-force", "500"]
    done = ran(*words, "--json")
    assert done.returncode == 3 and json.loads(done.stdout)["reason"].startswith("contact_force 500 N at distance")
    shown = ran(*words)
    assert shown.returncode == 3 and "contact_force 500 N at distance" in " ".join(shown.stdout.split())


def shown_by(*words: str) -> dict:
    """The JSON object that a command prints."""
    return json.loads(ran("control", *words, "--json").stdout)


def test_hold_and_reach_have_the_model_s_answer_with_units_in_names():
    model = rom.load()
    held = shown_by("hold", "--distance", "0.01")
    names = {"tip_m", "tip_error_m", "orientation_wxyz", "orientation_error_rad", "shortenings_m", "shortening_error_m"}
    names |= {"contact_force_N", "contact_force_error_N", "touch_distance_m", "touch_distance_error_m", "inside"}
    assert set(held["answer"]) == names
    expected = model.evaluate([*held["tensions"], 0.01])
    assert held["answer"]["orientation_wxyz"] == expected.orientation.tolist()
    assert held["answer"]["shortenings_m"] == dict(zip(["F1", "F2"], expected.shortenings, strict=True))
    assert held["answer"]["contact_force_N"] == pytest.approx(1.0, abs=1e-5)


def test_the_answer_of_a_reach_on_the_other_side_is_the_mirror_image():
    model = rom.load()
    tip = model.rod.rest + model.evaluate([20.0, 10.0, np.inf]).tip
    one, other = (shown_by("reach", "rom/finger.h5", *(str(x) for x in tip * side)) for side in ([1, 1, 1], [1, 1, -1]))
    assert one["sides"] == [1, 1] and other["sides"] == [1, -1]
    w, x, y, z = one["answer"]["orientation_wxyz"]
    assert other["answer"]["orientation_wxyz"] == pytest.approx([w, -x, -y, z], abs=1e-6)
    assert other["answer"]["tip_m"] == pytest.approx(np.array(one["answer"]["tip_m"]) * [1, 1, -1], abs=1e-6)
    assert other["answer"]["shortenings_m"] == pytest.approx(one["answer"]["shortenings_m"], abs=1e-6)


def test_a_table_s_answer_has_no_orientation_and_no_shortenings(table):
    answer = table.evaluate([30.0, 5.0, 0.01])
    assert answer.orientation is answer.shortenings is None
    assert set(answer.as_json(["F1", "F2"])) == {
        *("tip_m", "tip_error_m", "contact_force_N", "contact_force_error_N"),
        *("touch_distance_m", "touch_distance_error_m", "inside"),
    }
