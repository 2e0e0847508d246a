"""The march through a rod of elements: statics, kinematics, derivatives, and where its laws end."""

import numpy as np
import pytest

from rom.elements.polynomial import Polynomial
from tests.rom.elements import laws


def turned_by(turns: np.ndarray) -> np.ndarray:
    """Skew matrices of small turns, shape (n, 3, 3)."""
    return np.cross(turns[:, None], np.eye(3)).transpose(0, 2, 1)


def plate(elements, tensions, wrenches):
    """Centre and rotation of the plate seen from the clamp."""
    found = laws.marched(elements, tensions, wrenches)
    rotation = found.rotation.transpose(0, 2, 1)
    return -np.einsum("nij,nj->ni", rotation, found.place), rotation


def test_one_element_alone_is_its_law():
    tensions, wrenches = laws.inputs(2, 20, 0)
    element = laws.law(2, 0)
    found = laws.marched([element], tensions, wrenches)
    value = element.value(np.hstack([tensions, wrenches]))
    assert np.array_equal(found.place, value[:, :3]) and np.array_equal(found.wrenches[:, 0], wrenches)
    g = value[:, 3:]
    axis, angle = g / np.linalg.norm(g, axis=1)[:, None], 2 * np.arctan(np.linalg.norm(g, axis=1))
    assert np.einsum("nij,nj->ni", found.rotation, axis) == pytest.approx(axis, abs=1e-13)
    assert np.trace(found.rotation, axis1=1, axis2=2) == pytest.approx(1 + 2 * np.cos(angle), abs=1e-13)


def test_elements_of_one_curvature_make_a_circular_arc():
    """Law: a chord of an arc by an angle, whatever the inputs. All of them: an arc of as many."""
    angle, radius, count = 0.35, 0.02, 7
    chord = -radius * np.array([np.sin(angle), 1 - np.cos(angle), 0.0])
    lower, upper = laws.box(1)
    value = np.array([[*chord, 0.0, 0.0, np.tan(angle / 2)]])
    element = Polynomial(lower=lower, upper=upper, powers=np.zeros((1, 7), int), coefficients=value)
    found = laws.marched([element] * count, np.zeros((1, 1)), np.zeros((1, 6)))
    whole = count * angle
    assert found.place[0] == pytest.approx(-radius * np.array([np.sin(whole), 1 - np.cos(whole), 0.0]), abs=1e-15)
    turned = [[np.cos(whole), -np.sin(whole), 0], [np.sin(whole), np.cos(whole), 0], [0, 0, 1]]
    assert found.rotation[0] == pytest.approx(np.array(turned), abs=1e-14)


def test_every_section_carries_the_wrench_of_the_plate():
    """In the plate's frame forces are one, and moments about the plate's centre."""
    elements, (tensions, wrenches) = laws.finger(), laws.inputs(2, 20, 1)
    found = laws.marched(elements, tensions, wrenches)
    for k in range(1, len(elements)):
        section = laws.marched(elements[:k], tensions, wrenches)
        force, moment = (
            np.einsum("nij,nj->ni", section.rotation, part) for part in np.split(found.wrenches[:, k], 2, 1)
        )
        assert force == pytest.approx(wrenches[:, :3], abs=1e-13)
        assert moment + np.cross(section.place, force) == pytest.approx(wrenches[:, 3:], abs=1e-14)


def test_motions_are_differences_of_the_plates_poses():
    elements, (tensions, wrenches) = laws.finger(), laws.inputs(2, 20, 2)
    motion, (_, rotation) = laws.marched(elements, tensions, wrenches).motion, plate(elements, tensions, wrenches)
    steps = 1e-5 * (laws.box(2)[1] - laws.box(2)[0])
    for k, h in enumerate(steps):
        way = h * np.eye(8)[k]
        (after, ahead), (before, behind) = (
            plate(elements, tensions + sign * way[:2], wrenches + sign * way[2:]) for sign in (1, -1)
        )
        move = np.einsum("nji,nj->ni", rotation, (after - before) / (2 * h))
        turn = np.einsum("nji,njk->nik", rotation, (ahead - behind) / (2 * h))
        size = np.abs(motion[:, :3, k]).max()
        assert motion[:, :3, k] == pytest.approx(move, abs=1e-7 * size)
        assert turned_by(motion[:, 3:, k]) == pytest.approx(turn, abs=1e-7 * np.abs(motion[:, 3:, k]).max())


def test_beyond_its_box_an_element_goes_on_linearly_by_the_wrench_and_stays_by_the_tensions():
    element, (tensions, wrenches) = laws.law(2, 0), laws.inputs(2, 1, 3)
    wrenches[0, 4] = laws.MOST_MOMENT
    beyond = wrenches + [[0, 0, 0, 0, more, 0] for more in (0.01, 0.02)]
    edge, far = (
        laws.marched([element], tensions, wrenches),
        laws.marched([element], np.repeat(tensions, 2, axis=0), beyond),
    )
    assert edge.inside.all() and not far.inside.any()
    steps = far.place - edge.place
    assert 2 * steps[0] == pytest.approx(steps[1], abs=1e-16) and np.abs(steps[0]).max() > 1e-5
    for end, more in ((0.0, -3.0), (laws.MOST_TENSION, 5.0)):
        there, past = (laws.marched([element], np.array([[pull, 4.0]]), 0 * wrenches) for pull in (end, end + more))
        assert there.inside.all() and not past.inside.any()
        assert np.array_equal(there.place, past.place) and np.array_equal(there.motion[..., 1:], past.motion[..., 1:])
        assert np.any(there.motion[..., 0]) and not np.any(past.motion[..., 0])


def test_each_element_is_inside_where_its_own_wrench_is():
    """A force that bends the base beyond its box leaves the elements before inside."""
    elements, force = laws.finger(), np.array([[0.0, 0.9 * laws.MOST_FORCE, 0.0, 0.0, 0.0, 0.0]])
    found = laws.marched(elements, np.zeros((1, 2)), force)
    moments = np.abs(found.wrenches[0, :, 3:]).max(axis=1)
    assert (found.inside[0] == (moments <= laws.MOST_MOMENT)).all()
    assert found.inside[0, 0] and not found.inside[0, -1]


def test_a_force_larger_than_any_that_was_trained_is_outside_though_its_components_are_not():
    wrench = 0.9 * laws.MOST_FORCE * np.array([[1.0, 1.0, 0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]])
    assert laws.marched([laws.law(2, 0)], np.zeros((2, 2)), wrench).inside.tolist() == [[False], [True]]
