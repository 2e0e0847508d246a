"""The task of docs/grasping.md: solids are picked up, and what is not to be is refused or let go; its physics."""

import numpy as np
import pytest

pytest.importorskip("mujoco")

from control.mujoco.solids import SHAPES
from rom import TouchedSegment
from studies.grasping import physics
from studies.grasping.moments import moment
from studies.grasping.task import attempt, trial


@pytest.fixture(scope="module")
def model():
    return TouchedSegment.load()


@pytest.mark.parametrize("number", [11, 12, 13])
def test_a_solid_is_lifted_turned_and_put_down(model, number):
    row = attempt(model, trial(number, SHAPES[number % 5]))
    assert row["fate"] == "held"
    assert max(map(abs, row["slips"].values())) < 1e-3
    assert row["hardest"] < row["admissible_force"]
    assert not (row["left"] or row["lost"] or row["rubbed"])


def test_what_cannot_be_held_is_refused_before_anything_moves(model):
    row = attempt(model, trial(0, "box"))
    assert (row["fate"] == "refused" and "N" in row["reason"]) or "slip" in row["reason"]
    assert "closing_seconds" not in row


def test_what_follows_in_a_moment_is_friction_and_weight_and_not_along_the_normal(model):
    one, seen = trial(12, "cylinder"), []

    def look(simulation):
        if simulation.time > 3.0 and not seen:
            seen.append(moment(simulation, one.solid, 1))

    attempt(model, one, [look])
    (found,) = seen
    force, following = found["contact_force"], np.array(found["following"])
    normal = (np.array(found["wrench"]) - following)[:3] / force
    weight = 0.03  # of the plate and half of the rubber [N]
    assert abs(following[:3] @ normal) < weight
    assert np.linalg.norm(following[:3]) < one.solid.friction * force + weight
    assert found["obstacle"]["shape"] == "cylinder" and not found["beyond"]


def test_closed_loops_do_no_work(model):
    assert physics.pose_loop(model.rod)["share"] < 1e-3
    assert physics.tension_loop(model.rod, seconds=10.0)["share"] < 1e-3


@pytest.mark.parametrize("friction", [0.3, 0.6])
def test_a_plate_slides_at_the_angle_of_friction(model, friction):
    found = physics.sliding(model.rod, friction)
    assert found["sliding_median"] == pytest.approx(found["angle"], rel=0.03)
    assert found["largest"] <= found["angle"] * (1 + 1e-6)
    assert found["creep"] < 0.25 * physics.DRAG
