"""Friction on the rubber: without it nothing changes; forces are in the cone; what sticks moves along."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from rom import Plane, TouchedSegment, friction_history
from rom.rod.compiled.contacts import AXES, Contacts, find_contacts
from rom.rod.rod import Rod
from tests.rom.rod.friction.test_history import round_and_round, slides_in_the_cone
from tests.rom.rod.test_rubber_contact import SHAPES, bundled, pressed

__all__ = ["bundled"]


@pytest.mark.parametrize("shape", SHAPES)
def test_without_friction_it_is_the_answer_without_a_history(bundled: Rod, shape: str):
    random = np.random.default_rng(1)
    for _ in range(6):
        model, point = pressed(bundled, random, shape)
        out = model.outputs(point[None])[0]
        (state,) = friction_history(model, point, 0.0)
        assert state.status == "converged" and any(one.rubber for one in state.contacts)
        assert state.contact_force == pytest.approx(out[3], rel=1e-6, abs=1e-7)
        assert state.tip == pytest.approx(out[:3], abs=2e-8)
        assert abs(state.dissipated) < 1e-9


@pytest.mark.parametrize("shape", SHAPES)
def test_forces_are_in_the_cone_and_slide_on_it(bundled: Rod, shape: str):
    random, slides, rests, known = np.random.default_rng(2), 0, 0, 0
    for _ in range(6):
        model, point = pressed(bundled, random, shape)
        friction, way = random.uniform(0.2, 1.0), 10 ** random.uniform(-5, -3) * random.standard_normal(3)
        states = friction_history(model, [point] * 3, friction, moved=[0 * way, way, 0 * way])
        for state in states:
            known += state.status == "converged"
            if state.status == "converged":
                sliding = slides_in_the_cone(state, friction)
                slides, rests = slides + sliding, rests + len(state.contacts) - sliding
    assert known > 12 and slides > 10 and rests > 10


def before_plane(rod: Rod, depth: float) -> tuple[TouchedSegment, np.ndarray]:
    """A plane that presses on the rubber in the middle of a bent finger, by a depth [m] beyond touch."""
    tensions = np.array([45.0, 5.0])
    middle = rod.sections(tensions, at=[0.6 * rod.rest[0]])
    out = middle.rotations[0][:, 1]
    centre = tuple(middle.centres[0] + (rod.half_lengths[1] + 0.01) * out)
    model = TouchedSegment(
        rod=rod, obstacle=Plane(centre=centre, normal=tuple(-out), direction=tuple(out), distances=(-0.1, 0.1))
    )
    touch = float(model.outputs(np.array([[*tensions, np.inf]]))[0, 4])
    return model, np.array([*tensions, touch - depth])


def test_what_a_closed_way_takes_is_what_slides_lose(bundled: Rod):
    """The work of the object on the finger, integrated along a circle, once the history has forgotten its begin."""
    model, point = before_plane(bundled, 6e-4)
    n = np.array(model.obstacle.numbers()["axis"])
    one = np.cross(n, [0.0, 0.0, 1.0])
    work, dissipated = round_and_round(model, point, np.array([one, np.cross(n, one)]), 121, rubber=True)
    assert work == pytest.approx(dissipated, rel=0.05) and work > 1e-5


def test_what_sticks_moves_along(bundled: Rod):
    """A plane that is dragged by less than what the finger yields takes the rubber along, and back."""
    model, point = before_plane(bundled, 6e-4)
    n = np.array(model.obstacle.numbers()["axis"])
    way = 5e-5 * np.cross(n, [0.0, 0.0, 1.0])
    first, there, back = friction_history(model, [point] * 3, 5.0, moved=[0 * way, way, 0 * way])
    for state in (first, there, back):
        sliding = sum(one.force @ one.normal for one in state.contacts if one.slides)
        assert sliding < 0.05 * sum(one.force @ one.normal for one in state.contacts)
    assert (there.force - first.force) @ way > 1e-3 * np.linalg.norm(way)
    assert back.force == pytest.approx(first.force, abs=1e-2 * np.linalg.norm(there.force - first.force))
    assert there.dissipated < 0.05 * float(there.force @ way)


def at_loads(model: TouchedSegment, point: np.ndarray, loads: np.ndarray) -> Contacts:
    found = find_contacts(model.touching, point[:-1], float(point[-1]), np.zeros(3), loads)
    assert found is not None
    return found


@pytest.mark.parametrize("shape", SHAPES)
def test_wrenches_of_forces_turn_as_the_finger_moves(bundled: Rod, shape: str):
    """Against differences by loads, but for how the rubber changes its shape."""
    random, step, compared = np.random.default_rng(3), 1e-5, []
    for _ in range(3):
        model, point = pressed(bundled, random, shape)
        loads = model.answers(point).loads[0]
        at = at_loads(model, point, loads)
        size = len(at.motions)
        for column in random.permutation(size)[:4]:
            index = 6 * int(at.bodies[column // 6]) + column % 6
            one, other = (at_loads(model, point, loads + way * np.eye(len(loads))[index]) for way in (step, -step))
            if one.labels != at.labels or other.labels != at.labels:
                continue
            motion = np.append(at.motions[:, column], 0.0)
            for k in range(len(at.labels)):
                tangents = one.axes[k] @ other.axes[k].T  # these do not turn about the normal by more than the step
                assert np.abs(tangents - np.eye(AXES)).max() < 1e-2
                expected = at.changes[k, 0] @ motion[at.on[k]]
                rows = at.on[k][at.on[k] < size]
                found = (one.arms - other.arms)[rows, AXES * k] / (2 * step)
                scale = np.tile([1.0] * 3 + [1 / bundled.half_lengths[1]] * 3, len(rows) // 6)
                off = scale * (found - expected[at.on[k] < size])
                compared.append(np.abs(off).max() / max(np.abs(scale * found).max(), 1e-2))
    assert len(compared) > 20 and np.median(compared) < 0.05


def test_finer_increments_change_less(bundled: Rod):
    model, point = before_plane(bundled, 6e-4)
    n = np.array(model.obstacle.numbers()["axis"])
    way = 8e-4 * np.cross(n, [0.0, 0.0, 1.0])
    forces = [
        friction_history(model, [point] * 2, 0.4, moved=[0 * way, way], increments=count)[-1].force
        for count in (8, 16, 32)
    ]
    one, two = (float(np.linalg.norm(b - a)) for a, b in pairwise(forces))
    assert two < 0.7 * one + 1e-6 and two < 0.01 * np.linalg.norm(forces[-1])


def test_more_contacts_than_there_is_room_for_are_marked(bundled: Rod):
    """A plane that leans lies 0.6 mm deep along half of the finger: 96 contacts of some hundred are known."""
    normal = (-np.sin(0.1), -np.cos(0.1), 0.0)
    where = {"direction": (0.0, 1.0, 0.0), "distances": (-0.02, 0.05)}
    model = TouchedSegment(rod=bundled, obstacle=Plane(centre=(0.0, 0.0055, 0.0), normal=normal, **where))
    point = np.array([15.0, 0.0, 0.0])
    found = at_loads(model, point, np.zeros_like(model.answers(point).loads[0]))
    assert len(found.gaps) == 96 and found.gaps.max() < 0.0 and not found.inside
    assert at_loads(model, point - np.array([0.0, 0.0, -0.02]), np.zeros_like(model.answers(point).loads[0])).inside


def test_it_leaves_and_comes_back(bundled: Rod):
    model, point = before_plane(bundled, 6e-4)
    away = point + np.array([0.0, 0.0, 2e-3])
    first, gone, again = friction_history(model, [point, away, point], 0.5)
    assert gone.contacts == [] and gone.contact_force == 0.0
    assert again.status == "converged" and again.contact_force == pytest.approx(first.contact_force, rel=0.02)
    assert replace(gone, dissipated=0.0).tip == pytest.approx(model.outputs(away[None])[0, :3], abs=1e-9)
