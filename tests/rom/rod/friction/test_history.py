"""Coulomb's friction: without it nothing changes; what sticks moves along, what slides dissipates."""

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import ArrayLike

from rom import Sphere, TouchedSegment, friction_history
from rom.files.checked_file import ModelError
from rom.rod.friction.history import FrictionState
from rom.rod.objects.shapes import facing_plane
from tests.rom.elements import elastic_rod as rod
from tests.rom.rod.test_touch import touched

TENSIONS = (10.0, 2.0)
SHAPES = ["plane", "sphere", "cylinder", "hull"]


@pytest.fixture
def plane(finger) -> TouchedSegment:
    return TouchedSegment(rod=finger, obstacle=facing_plane(rod.SIDE, (0.0, 0.05)))


def touch(model: TouchedSegment) -> float:
    return float(model.outputs(np.array([[*TENSIONS, 0.04]]))[0, 4])


@pytest.mark.parametrize("shape", SHAPES)
def test_without_friction_it_is_the_answer_without_a_history(finger, shape):
    random, known = np.random.default_rng(4), 0
    for _ in range(12):
        model, point = touched(finger, random, shape)
        answer = model.answers(point)
        if not answer.inside[0]:
            continue
        known += 1
        state = friction_history(model, point, 0.0)[-1]
        assert state.status == "converged"
        assert state.contact_force == pytest.approx(answer.out[0, 3], rel=1e-6, abs=1e-7)
        assert state.tip == pytest.approx(answer.out[0, :3], abs=2e-8)
        assert abs(state.dissipated) < 1e-9
    assert known > 4


@pytest.mark.parametrize(
    "shape", [one if one != "hull" else pytest.param(one, marks=pytest.mark.long) for one in SHAPES]
)
def test_forces_are_in_the_cone_and_slide_on_it(finger, shape):
    """Along random ways of the object and changes of the tensions."""
    random, slid, known = np.random.default_rng(5), 0, 0
    for _ in range(12):
        model, point = touched(finger, random, shape)
        if not model.answers(point).inside[0]:
            continue
        friction = random.uniform(0.1, 1.0)
        rows = np.array([point, point + np.array([*random.uniform(-1, 1, 2), -1e-4]), point])
        states = friction_history(
            model, rows, friction, moved=10 ** random.uniform(-5, -3) * random.standard_normal((3, 3))
        )
        lost = 0.0
        for state in states:
            if np.isnan(state.contact_force):
                assert state.status != "converged" and np.isnan(state.tip).all()
                break
            known += 1
            assert state.dissipated >= lost - 1e-9
            lost = state.dissipated
            slid += slides_in_the_cone(state, friction)
    assert known > 10 and slid > 2


def slides_in_the_cone(state: FrictionState, friction: float) -> int:
    """Number of contacts that slide; no force is outside its cone."""
    for one in state.contacts:
        pressing = one.force @ one.normal
        along = np.linalg.norm(one.force - pressing * one.normal)
        assert pressing > -1e-6 and along <= friction * pressing + 1e-6
        assert not one.slides or along == pytest.approx(friction * pressing, abs=1e-6)
    assert state.force == pytest.approx(sum((one.force for one in state.contacts), np.zeros(3)), abs=1e-12)
    return sum(one.slides for one in state.contacts)


def test_what_sticks_goes_where_the_object_goes(plane):
    """By another way than the solve: the rod itself under the wrench that was found."""
    d, ways = touch(plane) - 3e-4, np.array([[0, 0, 0], [1e-5, 0, 0], [1e-5, 0, 1e-4], [0, 0, 0]], float)
    states = friction_history(plane, [[*TENSIONS, d]] * 4, 20.0, moved=ways)
    first = next(one for one in states[0].contacts if not one.slides)
    for state, way in zip(states, ways, strict=True):
        assert state.status == "converged"
        same = min(state.contacts, key=lambda one, at=first.place + way: float(np.linalg.norm(one.place - at)))
        assert not same.slides and same.place - way == pytest.approx(first.place, abs=1e-8)
    forces = np.array([state.force for state in states])
    assert np.linalg.norm(forces[1] - forces[0]) > 0.02  # it holds on
    assert forces[3] == pytest.approx(forces[0], abs=2e-2 * np.abs(forces).max())  # but for another corner


def test_a_wrench_with_friction_is_one_that_the_rod_transmits_there(plane):
    d = touch(plane) - 5e-4
    state = friction_history(plane, [[*TENSIONS, d]], 0.5)[0]
    # The rod's plate under these forces, which are known in space: their parts in its frame turn with it.
    centre, turned = rod.plate(np.array(TENSIONS), np.zeros(6))
    for _ in range(60):
        force = sum((turned.T @ one.force for one in state.contacts), np.zeros(3))
        moment = sum((turned.T @ np.cross(one.place - centre, one.force) for one in state.contacts), np.zeros(3))
        centre, turned = rod.plate(np.array(TENSIONS), np.array([*force, *moment]))
    assert centre - plane.rod.rest == pytest.approx(state.tip, abs=2e-6)


def test_finer_increments_change_less_and_less(plane):
    d, way = touch(plane) - 8e-4, [[0, 0, 0], [8e-4, 0, 3e-4]]
    forces = [
        friction_history(plane, [[*TENSIONS, d]] * 2, 0.4, moved=way, increments=count)[-1].force
        for count in (8, 16, 32, 64)
    ]
    changes = [np.linalg.norm(one - other) for one, other in pairwise(forces)]
    assert changes[2] < 0.7 * changes[1] < 0.49 * changes[0] + 1e-9 and changes[2] < 0.01 * np.linalg.norm(forces[-1])


def test_to_and_fro_closes_a_loop_that_dissipates(plane):
    d, there = touch(plane) - 5e-4, [1.5e-3, 0.0, 0.0]
    ways = np.array([[0, 0, 0], *[there, np.negative(there)] * 3], float)
    states = friction_history(plane, [[*TENSIONS, d]] * 7, 0.3, moved=ways, increments=24)
    forces, lost = np.array([one.force for one in states]), np.array([one.dissipated for one in states])
    assert forces[6] == pytest.approx(forces[4], rel=1e-5) and forces[5] == pytest.approx(forces[3], rel=1e-5)
    assert lost[6] - lost[4] == pytest.approx(lost[4] - lost[2], rel=1e-3) and lost[2] > 1e-6
    work, dissipated = round_and_round(plane, [*TENSIONS, d], np.eye(3)[[0, 2]], 241)
    assert work == pytest.approx(dissipated, rel=0.01) and work > 0


def round_and_round(
    model: TouchedSegment, point: ArrayLike, axes: np.ndarray, count: int, rubber: bool = False
) -> tuple[float, float]:
    """Work of the object on the finger, and what is lost, in the second of two circles: the begin is forgotten."""
    fine = np.linspace(0, 2 * np.pi, count)
    circle = 1.5e-3 * np.column_stack([np.cos(fine), np.sin(fine)]) @ axes
    twice = np.vstack([circle, circle[1:]])
    found = friction_history(model, [point] * len(twice), 0.3, moved=twice, increments=1)[count - 1 :]
    assert all(state.status == "converged" and state.contacts[0].rubber == rubber for state in found)
    force = np.array([one.force for one in found])
    work = float(np.sum((force[1:] + force[:-1]) / 2 * np.diff(circle, axis=0)))
    return work, found[-1].dissipated - found[0].dissipated


def test_plates_of_two_segments_stick_and_slide(finger):
    both = finger.assembled(rod.in_series(rod.LENGTH, rod.LENGTH))
    model = TouchedSegment(rod=both, obstacle=facing_plane(rod.SIDE, (0.0, 0.1)))
    tensions = [4.0, 1.0]
    d = float(model.outputs(np.array([[*tensions, 0.09]]))[0, 4]) - 5e-4
    point = [*tensions, d]
    assert friction_history(model, [point], 0.0)[0].contact_force == pytest.approx(
        model.outputs([point])[0, 3], rel=1e-6
    )
    rough = friction_history(model, [point, point], 0.5, moved=[[0, 0, 0], [5e-4, 0, 0]])
    assert [one.status for one in rough] == ["converged"] * 2 and rough[1].force[0] > rough[0].force[0]


@pytest.mark.long
def test_what_is_not_known_is_marked(plane, finger):
    far = friction_history(plane, [[*TENSIONS, 0.049]], 0.5)[0]
    assert far.status == "converged" and far.contacts == [] and far.contact_force == 0.0
    assert friction_history(plane, [[*TENSIONS, 0.06]], 0.5)[0].status == "out_of_domain"
    hard = friction_history(plane, [[*TENSIONS, touch(plane) - 6e-3]], 0.5)[0]
    assert hard.status != "converged"


def test_a_ball_does_not_pass_a_plate_by_between_two_increments(finger):
    """It would be on the far side after one, pressing on nothing."""
    free = finger.place(TENSIONS)
    _, out, across = free.rotations[0].T
    ball = Sphere(
        centre=tuple(free.centres[0] + (rod.SIDE / 2 + 0.002) * out - 0.006 * across),
        radius=0.002,
        direction=tuple(out),
        distances=(-0.01, 0.02),
    )
    model = TouchedSegment(rod=finger, obstacle=ball)
    ways = np.outer([0.0, 1.0], 0.012 * across)
    forces = [
        friction_history(model, [[*TENSIONS, -3e-4]] * 2, 0.0, moved=share * ways, increments=count)[-1].force
        for share in (0.5,)
        for count in (1, 64)
    ]
    assert np.linalg.norm(forces[1]) > 0.05 and forces[0] == pytest.approx(forces[1], rel=1e-4)


@pytest.mark.long
def test_what_is_lost_on_the_way_is_not_known_again(plane):
    deep = touch(plane) - 6e-3
    rows = [[*TENSIONS, 0.02], [*TENSIONS, deep], [*TENSIONS, 0.02]]
    states = friction_history(plane, rows, 0.5)
    assert states[0].status == "converged" and states[2].status != "converged"


def test_bad_input_is_said_in_a_sentence(plane):
    with pytest.raises(ModelError, match="points must be F1, F2, d"):
        friction_history(plane, [[1.0, 2.0]], 0.5)
    with pytest.raises(ModelError, match="points must be F1, F2, d"):
        friction_history(plane, np.zeros((0, 3)), 0.5)
    with pytest.raises(ModelError, match="moved of shape"):
        friction_history(plane, [[1.0, 2.0, 0.01]], 0.5, moved=[0.0, 0.0])
    for friction, increments in ((-0.1, 8), (np.nan, 8), (0.5, 0)):
        with pytest.raises(ValueError, match="friction"):
            friction_history(plane, [[1.0, 2.0, 0.01]], friction, increments=increments)


def test_a_ball_rolls_on_a_face_where_it_sticks(finger):
    """Its contact goes on along the plate by half of what the ball's surface would slide by: none of it slides."""
    free = finger.place(TENSIONS)
    _, along, across = free.rotations[0].T
    centre = free.centres[0] + (rod.SIDE / 2 + 0.01) * along
    ball = Sphere(centre=tuple(centre), radius=0.01, direction=tuple(along), distances=(-0.01, 0.02))
    model = TouchedSegment(rod=finger, obstacle=ball)
    ways = np.outer([0.0, 1.0], 2e-5 * across)
    smooth, rough = (
        friction_history(model, [[*TENSIONS, -2e-4]] * 2, friction, moved=ways)[-1] for friction in (0.0, 3.0)
    )
    assert smooth.status == rough.status == "converged" and len(rough.contacts) == 1
    assert not rough.contacts[0].slides
    assert np.linalg.norm(rough.force - smooth.force) > 1e-3
    assert rough.dissipated < 1e-9


def test_a_history_that_fails_beyond_what_was_trained_says_so(plane):
    """Deep into the plane: the wrench leaves the trained box before there is no equilibrium any more."""
    point = np.array([*TENSIONS, touch(plane) - 2e-4])
    states = friction_history(plane, [point, point], 0.5, moved=[[0, 0, 0], [0, -0.1, 0]])
    assert states[0].status == "converged"
    assert states[1].status == "out_of_domain"
