"""Increments of contact with friction: what begins them, what ends them, and what they leave as it is."""

from dataclasses import replace

import numpy as np
import pytest

from rom.rod.friction.contact_law import OPEN, SLIDES, STICKS
from rom.rod.friction.increment import Loads, Resting, advance, free

TENSIONS = np.array([12.0, 3.0])
SIGNS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])


def loads(d: float, moved=(0.0, 0.0, 0.0)) -> Loads:
    return Loads(TENSIONS, d, np.array(moved))


def led(model, state: Resting, friction: float, *ways: Loads) -> Resting:
    """State after a path of small increments."""
    for one in ways:
        state = advance(model, state, one, friction)
        assert state is not None
    return state


def pressed(model, friction: float, deep: float = 5e-4) -> Resting:
    """The finger before a plane that has come from where it touches."""
    touch = float(model.outputs([[*TENSIONS, 0.05]])[0, 4])
    ways = [loads(touch - deep * share) for share in np.linspace(0, 1, 6)[1:]]
    found = led(model, free(model, loads(touch)), friction, *ways)
    assert (found.states != OPEN).any()
    return found


def test_a_share_of_the_way_divides_every_load():
    one, other = loads(0.01, (0, 0, 0)), Loads(np.add(TENSIONS, [4.0, -2.0]), 0.03, np.array([1e-3, 0, 2e-3]))
    quarter = one.towards(other, 0.25)
    assert quarter.tensions == pytest.approx(np.add(TENSIONS, [1.0, -0.5])) and quarter.d == pytest.approx(0.015)
    assert quarter.moved == pytest.approx([2.5e-4, 0, 5e-4])
    assert one.towards(other, 0.0).d == one.d and one.towards(other, 1.0) is other


def test_the_free_finger_has_the_gaps_of_its_plate_s_corners(model):
    d = 0.045
    found, placed = free(model, loads(d)), model.rod.place(TENSIONS)
    corners = placed.centres[0] + (SIGNS * model.rod.half_lengths) @ placed.rotations[0].T
    plane = model.rod.half_lengths[1] + d
    of_plate = found.contacts.gaps[~found.contacts.rubber]
    assert np.sort(of_plate) == pytest.approx(np.sort(plane - corners[:, 1]), abs=1e-12)
    assert (found.states == OPEN).all() and not found.forces.any() and found.dissipated == 0
    beside = free(model, loads(d, (0.003, 0.0, 0.004)))  # a plane that moves along itself stays where it is
    assert beside.contacts.gaps == pytest.approx(found.contacts.gaps, abs=1e-12)


def test_an_increment_without_a_change_changes_nothing(model):
    for friction in (0.0, 0.5, 3.0):
        once = pressed(model, friction)
        again = advance(model, once, once.loads, friction)
        assert again.wrenches == pytest.approx(once.wrenches, abs=1e-7) and again.wrenches.any()
        for label, force in again.by_label.items():
            assert force == pytest.approx(once.by_label[label], abs=1e-7)
        assert abs(again.dissipated) < 1e-12


def test_what_sticks_is_carried_by_the_plane_and_dissipates_nothing(model):
    once, carried = pressed(model, 3.0), np.array([0.0, 0.0, 2e-5])
    touched = once.states == STICKS
    near = advance(model, once, once.loads._replace(moved=carried), 3.0)
    assert touched.any() and (near.states == once.states).all() and near.dissipated == 0
    assert near.contacts.places[touched] - once.contacts.places[touched] == pytest.approx(carried[None], abs=1e-7)
    assert near.forces.sum(axis=0)[2] > once.forces.sum(axis=0)[2]


def test_a_plane_that_goes_far_slides_with_the_friction_times_the_force_that_presses(model):
    friction, once = 0.5, pressed(model, 0.5)
    ways = [once.loads._replace(moved=np.array([0.0, 0.0, step])) for step in np.arange(1, 11) * 2e-4]
    far = led(model, once, friction, *ways)
    force = far.forces.sum(axis=0)
    assert (far.states[far.states != OPEN] == SLIDES).all() and far.dissipated > 0
    assert np.hypot(force[0], force[2]) == pytest.approx(-friction * force[1], rel=1e-6) and force[2] > 0
    assert far.dissipated == pytest.approx(force[2] * 2e-4, rel=0.2)  # the plane's work, but for a little elastic one


def test_a_motion_by_d_is_that_motion_of_the_object_along_its_direction(model):
    """Also along the plane, where friction drags the finger along."""
    slanted = replace(model, obstacle=replace(model.obstacle, direction=(0.4, 1.0, -0.3)))
    friction, far = 0.5, 1e-4
    touch = float(slanted.outputs([[*TENSIONS, 0.05]])[0, 4])
    begun = free(slanted, loads(touch))
    by_d, by_moves = (
        led(slanted, begun, friction, *(way(k * far) for k in (1, 2, 3)))
        for way in (lambda s: loads(touch - s), lambda s: loads(touch, -s * slanted.direction))
    )
    assert by_d.forces == pytest.approx(by_moves.forces, abs=1e-7)
    along = by_d.forces.sum(axis=0)[[0, 2]]
    assert np.linalg.norm(along) > 0.01 and by_d.dissipated == pytest.approx(by_moves.dissipated, rel=1e-4)
