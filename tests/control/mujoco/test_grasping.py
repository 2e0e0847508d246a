"""The task of docs/grasping.md: solids are picked up, and what is not to be is refused or let go; its physics."""

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from control.mujoco.solids import SHAPES  # noqa: E402
from rom import Rod, TouchedSegment  # noqa: E402
from studies.grasping.task import FOUND, STEP, approach, attempt, close, over, planned  # noqa: E402
from studies.grasping.trials import trial  # noqa: E402
from tests.control.mujoco.dragged_wall import SOFT, before_a_wall, sliding  # noqa: E402


@pytest.fixture(scope="module")
def model():
    return TouchedSegment.load()


@pytest.mark.parametrize("number", [12, *(pytest.param(one, marks=pytest.mark.long) for one in (11, 13))])
def test_a_solid_is_lifted_turned_and_put_down(model, number):
    row = attempt(model, trial(number, SHAPES[number % 5]))
    assert row["fate"] == "held"
    assert max(map(abs, row["slips"].values())) < 1e-3
    assert row["hardest"] < row["admissible_force"]
    assert not (row["left"] or row["lost"])


@pytest.mark.parametrize("number", [10, *(pytest.param(one, marks=pytest.mark.long) for one in (11, 12))])
def test_a_held_solid_creeps_by_less_than_a_hundredth_of_a_micrometre_a_second(model, number):
    """A box of 229 g, a ball of 245 g, a cylinder of 32 g; creep slows down, so that it is below 0.6 um in a minute."""
    one = trial(number, SHAPES[number % 5])
    layout, places = planned(model, one), []
    hand = over(model, one, layout)
    height, _ = approach(hand, one, layout)
    closing = close(hand, one, layout)
    assert not closing.failed()
    for seconds in (1.0, 0.5, 0.5, 0.5):  # lifted, at rest, and held
        hand.carry(closing.grips, 2, height + 0.003, seconds)
        solid, palm = (hand.simulation.data.body(name).xpos for name in ("object", "palm"))
        places.append(solid - palm)
    first, second = np.linalg.norm(np.diff(places[1:], axis=0), axis=1) / 0.5
    assert second < 1e-8 and (second < first or first < 1e-10)


def test_fingers_find_the_table_and_the_arm_the_solid(model):
    one = trial(12, "cylinder")
    layout, missed = planned(model, one), np.linalg.norm(one.error[:2])
    hand = over(model, one, layout)
    _, table_error = approach(hand, one, layout)
    assert abs(one.error[2]) > 1e-3 > 5 * table_error  # the arm begins too low by more than what the fingers leave
    assert not hand.simulation.contact_forces().any() and hand.beside() == pytest.approx(missed, abs=1e-4)
    close(hand, one, layout)
    assert hand.beside() < min(FOUND[:2]) and hand.beside() < missed / 2
    assert hand.hardest < one.solid.admissible_force


def test_what_cannot_be_held_is_refused_before_anything_moves(model):
    row = attempt(model, trial(0, "box"))
    assert (row["fate"] == "refused" and "N" in row["reason"]) or "slip" in row["reason"]
    assert "closing_seconds" not in row


@pytest.mark.long
def test_a_solid_that_is_let_go_is_not_crushed_when_fingers_open(model):
    row = attempt(model, trial(329, "mesh"))
    assert row["fate"] == "let go" and row["hardest"] < 0.5 * row["admissible_force"]  # 1.1 if they open at once


def tension_loop(rod: Rod, rounds: int = 2, seconds: float = 20.0) -> dict[str, float]:
    """Tensions led around a closed loop before a wall on springs without friction: net work done on the wall."""
    simulation = before_a_wall(rod, 0.0, SOFT)
    data, wall = simulation.data, simulation.data.body("wall")
    simulation.pull(0, (48.0, 10.0))
    simulation.advance(1.0)
    work = exchanged = 0.0
    before, force = wall.xpos.copy(), np.zeros(6)
    steps = round(seconds / STEP)
    for k in range(rounds * steps):
        angle = 2 * np.pi * k / steps
        simulation.pull(0, (40.0 + 8.0 * np.cos(angle), 10.0 + 8.0 * np.sin(angle)))
        simulation.step()
        pushed = np.zeros(3)
        for i in range(data.ncon):
            mujoco.mj_contactForce(simulation.model, data, i, force)
            sign = 1.0 if simulation.model.geom_bodyid[data.contact.geom[i][1]] == wall.id else -1.0
            pushed += sign * force[0] * data.contact.frame[i][:3]
        done, before = float(pushed @ (wall.xpos - before)), wall.xpos.copy()
        if k >= (rounds - 1) * steps:
            work, exchanged = work + done, exchanged + abs(done)
    return {"work": work, "exchanged": exchanged, "share": abs(work) / exchanged}


@pytest.mark.long
def test_tensions_led_around_a_closed_loop_do_no_work(model):
    assert tension_loop(model.rod, seconds=10.0)["share"] < 1e-3


@pytest.mark.parametrize("friction", [0.6, pytest.param(0.3, marks=pytest.mark.long)])
def test_a_plate_slides_at_the_angle_of_friction(model, friction):
    found = sliding(model.rod, friction)
    assert found["sliding_median"] == pytest.approx(found["angle"], rel=0.03)
    assert found["largest"] <= found["angle"] * (1 + 1e-6)
