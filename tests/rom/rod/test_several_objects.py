"""Several objects at once: against one alone, differences, reciprocity, and what presses."""

import json

import numpy as np
import pytest

from rom import AmongObjects, Cylinder, Plane, Sphere, TouchedSegment, box
from rom.files.checked_file import ModelError

RANGE = (-0.05, 0.1)
BALL = Sphere(centre=(0.046, 0.022, 0.002), direction=(0.0, 1.0, 0.0), radius=0.012, distances=RANGE)
POST = Cylinder(centre=(0.028, -0.0155, 0.0), direction=(0.1, -1.0, 0.0), radius=0.010, distances=RANGE)
BRICK = box(centre=(0.046, 0.002, -0.0125), sides=(0.02, 0.03, 0.012), direction=(0.0, 0.1, -1.0), distances=RANGE)
WALL = Plane(centre=(0.0, 0.009, 0.0), direction=(0.0, 1.0, 0.0), normal=(0.0, -1.0, 0.0), distances=RANGE)
GROUPS = [(BALL, POST), (BALL, BRICK), (POST, WALL), (BALL, POST, BRICK)]


def touching(model, tensions, random):
    """A point at which every object is beyond where it touches the free finger."""
    away = np.append(tensions, np.full(len(model.objects), np.inf))
    touch = np.maximum(model.evaluate(away).touch_distance, RANGE[0])  # some pass by
    return np.append(tensions, touch - random.uniform(2e-4, 1.5e-3, len(touch)))


@pytest.fixture(scope="module")
def pressed(rod):
    """Models and points with several objects that press, inside."""
    random, found = np.random.default_rng(4), []
    for group in GROUPS:
        model = AmongObjects(rod=rod, obstacles=group)
        for _ in range(40):
            point = touching(model, random.uniform(0, 25, 2), random)
            answer = model.evaluate(point)
            if answer.inside and (np.asarray(answer.contact_force) > 0.02).sum() > 1:
                found.append((model, point))
            if len([1 for one, _ in found if one is model]) == 3:
                break
    assert len({len(model.objects) for model, _ in found}) == 2 and len(found) >= 10
    return found


def test_one_object_among_others_that_are_away_answers_as_alone(rod):
    alone, among = TouchedSegment(rod=rod, obstacle=BALL), AmongObjects(rod=rod, obstacles=(POST, BALL, BRICK))
    for tensions in ([40.0, 0.0], [70.0, 20.0]):
        touch = alone.evaluate([*tensions, np.inf]).touch_distance
        one = alone.evaluate([*tensions, touch - 1e-3])
        many = among.evaluate([*tensions, np.inf, touch - 1e-3, np.inf])
        assert one.inside and many.inside and one.contact_force > 0.05
        assert many.contact_force == pytest.approx([0.0, one.contact_force, 0.0], rel=1e-6)
        assert many.touch_distance[1] == one.touch_distance and many.tip == pytest.approx(one.tip, abs=1e-7)
        assert many.error["contact_force"][1] == pytest.approx(one.error["contact_force"], rel=1e-6)


def off(model, point):
    """By input, how far derivatives are from differences, over the largest of the input's; of tensions together."""
    steps = np.where(np.arange(len(point)) < 2, 1e-3, 2e-7)
    ahead, behind = (model.answers(point + sign * np.diag(steps)) for sign in (1, -1))
    exact = model.jacobian(point)
    scale = np.maximum(np.abs(exact).max(axis=0), 1e-6 * np.abs(exact).max())  # an object may not press at all
    scale[:2] = scale[:2].max()
    return np.abs((ahead.out - behind.out).T / (2 * steps) - exact).max(axis=0) / scale


def test_derivatives_are_those_of_the_answers(rod):
    """Plates agree to the resolution of differences."""
    above = Sphere(centre=(0.0500, 0.010, 0.001), direction=(0.0, 1.0, 0.0), radius=0.004, distances=RANGE)
    below = Sphere(centre=(0.0510, -0.010, -0.001), direction=(0.1, -1.0, 0.2), radius=0.004, distances=RANGE)
    model, random, compared = AmongObjects(rod=rod, obstacles=(above, below)), np.random.default_rng(4), 0
    for _ in range(30):
        point = touching(model, random.uniform(0, 8, 2), random)
        which = {(one.object, one.rubber) for one in model.contact_forces(point)}
        if which != {(0, False), (1, False)} or not model.evaluate(point).inside:
            continue
        assert off(model, point).max() < 5e-4
        compared += 1
    assert compared >= 3


def test_derivatives_of_rubber_are_those_of_the_answers_but_for_its_shape(pressed):
    """The effect of a slice's shape under load is not among them."""
    assert np.median(np.concatenate([off(model, point) for model, point in pressed])) < 0.02


def test_what_one_object_does_to_another_s_force_is_mutual(pressed):
    for model, point in pressed:
        m = len(model.objects)
        stiffness = model.jacobian(point)[3 : 3 + m, -m:]
        assert stiffness == pytest.approx(stiffness.T, abs=0.02 * np.abs(stiffness).max())


def test_a_motion_of_an_object_along_its_direction_is_its_distance(pressed):
    for model, point in pressed:
        found, m = model.answers(point, by_object=True), len(model.objects)
        moves = found.by_object[0].reshape(-1, m, 6)
        for k, one in enumerate(model.objects):
            along = moves[:, k, :3] @ one.numbers()["direction"]
            rows = 3 + m  # touch distances are those of d = 0 moved along
            assert along[:rows] == pytest.approx(found.jacobians[0, :rows, 2 + k], rel=1e-9, abs=1e-9)


def test_every_object_s_force_is_that_of_its_contacts_in_any_order(pressed):
    for model, point in pressed:
        answer, felt = model.evaluate(point), np.zeros(len(model.objects))
        for contact in model.contact_forces(point):
            felt[contact.object] -= contact.force @ model.objects[contact.object].numbers()["direction"]
        assert felt == pytest.approx(answer.contact_force, rel=1e-6)
        turned = AmongObjects(rod=model.rod, obstacles=model.objects[::-1])
        other = turned.evaluate(np.append(point[:2], point[:1:-1]))
        assert other.contact_force[::-1] == pytest.approx(answer.contact_force, rel=1e-6)
        assert np.isfinite(answer.error["contact_force"]).all() and answer.error["tip"] > 0


def test_answers_are_shown_by_object(pressed):
    model, point = pressed[0]
    answer = model.evaluate(point)
    plain = json.loads(json.dumps(answer.as_json(["F1", "F2"])))
    assert plain["contact_force_N"] == answer.contact_force.tolist() and len(plain["touch_distance_error_m"]) == 2
    shown = answer._repr_html_() + model.evaluate([point, point])._repr_html_() + model._repr_html_()
    assert "contact force 1" in shown and "contact force 2" in shown and "d2" in shown


def test_wrong_numbers_of_objects_and_parameters_are_refused(rod):
    with pytest.raises(ModelError, match="obstacles must be 1 to 8, got 0"):
        AmongObjects(rod=rod, obstacles=())
    with pytest.raises(ModelError, match="obstacles must be 1 to 8, got 9"):
        AmongObjects(rod=rod, obstacles=[BALL] * 9)
    with pytest.raises(ModelError, match="parameters must be F1, F2, d1, d2"):
        AmongObjects(rod=rod, obstacles=(BALL, POST)).evaluate([1.0, 2.0, 0.01])


@pytest.mark.parametrize(("along", "asymmetry"), [(0.0075, 0.04), (0.0146, 0.015), (0.020, 0.008), (0.030, 0.004)])
def test_a_ball_on_the_rubber_and_one_at_the_tip_are_reciprocal(rod, along, asymmetry):
    # Maxwell and Betti: dF_1/dd_2 = dF_2/dd_1. Without the couples of forces on bulging faces: 13, 3.3, 1.6 and 0.6 %.
    half, radius, step = rod.half_lengths[1], 0.004, 2e-6
    pressed = Sphere(centre=(along, half + radius, 0.0), direction=(0.0, 1.0, 0.0), radius=radius, distances=RANGE)
    tip = Sphere(centre=(0.0495, -half - radius, 0.0), direction=(0.0, -1.0, 0.0), radius=radius, distances=RANGE)
    model, point = AmongObjects(rod=rod, obstacles=(pressed, tip)), np.array([0.0, 0.0, -2e-4, -5e-5])
    steps = [np.array([0.0, 0.0, *row]) * step for row in np.eye(2)]
    slopes = [(model.evaluate(point + one).contact_force - model.evaluate(point - one).contact_force) for one in steps]
    assert slopes[0][1] == pytest.approx(slopes[1][0], rel=asymmetry) and slopes[0][1] < 0
