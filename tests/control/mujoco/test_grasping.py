"""The task of docs/grasping.md: solids are picked up, and what is not to be is refused or let go; its physics."""

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from control.mujoco.solids import POSE_ERROR, SHAPES  # noqa: E402
from rom import Rod, TouchedSegment  # noqa: E402
from studies.grasping.closing import Closing  # noqa: E402
from studies.grasping.hand import CLEAR, OPENING  # noqa: E402
from studies.grasping.task import FOUND, STEP, approach, attempt, close, closed, over, planned  # noqa: E402
from studies.grasping.trials import PERIOD, trial  # noqa: E402
from tests.control.mujoco.dragged_wall import SOFT, before_a_wall, sliding  # noqa: E402

LOCATED = 5e-4  # error of a solid's centre, as fingers that all touch measure it [m]


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
    assert hand.beside() < min(FOUND[:2]) + LOCATED and hand.beside() < missed / 2
    assert hand.hardest < one.solid.admissible_force


def test_a_solid_that_fingers_locate_aside_is_closed_about_again(model):
    """A cylinder, which tips if fingers squeeze it there."""
    one = trial(137, "cylinder")
    layout = planned(model, one)
    first, second = (over(model, one, layout) for _ in range(2))
    for hand in (first, second):
        approach(hand, one, layout)
    touch = closed(first, one, layout, max(FOUND[:2]))
    solid, palm = (first.simulation.data.body(name).xpos[:2] for name in ("object", "palm"))
    assert touch.again and touch.ended and touch.share < 1
    assert np.linalg.norm(touch.centre) > max(FOUND[:2]) and touch.centre == pytest.approx(solid - palm, abs=LOCATED)
    closing = close(second, one, layout)
    assert not closing.failed() and closing.share == 1
    assert second.beside() < LOCATED and second.tilt() < np.radians(0.5)


def test_a_mesh_is_expected_where_its_own_faces_are(model):
    """It is twice as long as wide: its faces are up to 6 mm from its mean half-width."""
    one = trial(214, "mesh")
    layout = planned(model, one)
    widths = layout.solid.turned(layout.turn).half_widths(layout.gripper.directions)
    assert np.abs(widths - layout.solid.radius).max() > 5e-3
    gripper, wanted = layout.gripper, layout.targets.contact_forces
    distances = gripper.radius - widths - gripper.directions @ [0.001, -0.002]
    for half_widths, doubt in ((widths, ""), (np.full(4, layout.solid.radius), "finds its face")):
        closing = Closing(gripper, gripper.grips(wanted), wanted, half_widths=half_widths, uncertain=1.5 * POSE_ERROR)
        for grip, distance in zip(closing.grips, distances, strict=True):
            grip.distance = distance
        assert doubt in closing.misplaced() and bool(doubt) == bool(closing.misplaced())
        assert doubt or closing.centre == pytest.approx([0.001, -0.002])


def test_what_cannot_be_held_is_refused_before_anything_moves(model):
    row = attempt(model, trial(0, "box"))
    assert (row["fate"] == "refused" and "N" in row["reason"]) or "slip" in row["reason"]
    assert "closing_seconds" not in row


@pytest.mark.parametrize("number", [133, pytest.param(213, marks=pytest.mark.long)])
def test_a_cone_that_tipped_in_the_grip_is_pressed_less_when_fingers_open(model, number):
    """Fingers that open at once press it with up to 1.8 times the admissible force."""
    one = trial(number, "cone")
    layout = planned(model, one)
    hand = over(model, one, layout)
    approach(hand, one, layout)
    closing = closed(hand, one, layout)  # aside: it tips
    assert closing.doubt and hand.tilt() > np.radians(1)
    hand.release(np.array([grip.tensions for grip in closing.grips]))
    assert hand.hardest < 0.8 * one.solid.admissible_force
    assert not hand.on_solid().any()


def test_edges_that_touch_do_not_get_lower_while_fingers_open(model):
    one = trial(12, "cylinder")
    layout = planned(model, one)
    hand = over(model, one, layout)
    hand.simulation.wanted[:, layout.gripper.model.lead] = 50.0
    hand.move(np.array([0.0, 0.0, 0.05]), 0.3)  # above the solid
    hand.move(hand.mount[:3].copy(), 0.2)  # at rest
    heights, begun = list[float](), hand.height
    compiled = hand.simulation.model
    body = compiled.body("finger 0 plate 0")
    plate = compiled.geom(int(body.geomadr[0] + body.geomnum[0] - 1))

    def look(simulation):
        at = simulation.data.geom(plate.id)
        heights.append(float(at.xpos[2] + at.xmat[6:8] @ plate.size[:2]))

    hand.looks.append(look)
    hand.open(hand.simulation.wanted.copy(), np.zeros_like(hand.simulation.wanted))
    assert len(heights) == round(OPENING / PERIOD) and min(heights) > heights[0] - 1e-4
    assert not hand.simulation.wanted.any() and hand.height - begun > 3 * CLEAR


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
