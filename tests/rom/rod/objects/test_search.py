"""Touches locate an object; where they cannot, the answer reports it."""

from dataclasses import replace

import numpy as np
import pytest

from rom import Sphere, TouchedSegment, find_object
from rom.rod.objects.shapes import facing_plane
from tests.rom.elements import elastic_rod as rod

# Which bend the finger so far to the side that the ball meets its plate's front edge, its face and its sides.
TENSIONS = np.array([[8, 0], [10, 2], [9, 5], [12, 1], [11, 7], [11, 4], [9, 9], [8, 7]], float)
BALL = Sphere(centre=(0.0495, 0.0172, 0.003), radius=0.01, direction=(0, 1, 0), distances=(-0.02, 0.02))


@pytest.fixture
def ball(finger) -> TouchedSegment:
    return TouchedSegment(rod=finger, obstacle=BALL)


def felt(model: TouchedSegment, distance: float = 0.0) -> np.ndarray:
    found = model.answers(np.column_stack([TENSIONS, np.full(len(TENSIONS), distance)]))
    assert found.inside.all() and (found.out[:, 3] > 0).all()
    return found.out[:, 3]


def away(model: TouchedSegment, way: tuple) -> TouchedSegment:
    return replace(model, obstacle=replace(BALL, centre=tuple(np.add(BALL.centre, way))))


@pytest.mark.parametrize("way", [(1e-3, -1e-3, 2e-3), (-2e-3, 2e-3, -1e-3), (0.0, 4e-3, 0.0)])
def test_a_ball_is_found_where_it_is(ball, way):
    """From a guess millimetres off, some of whose touches it does not even reach. Places where the rubber would touch
    may explain the same forces, within their larger errors."""
    found = find_object(away(ball, way), TENSIONS, felt(ball))
    assert found.centre == pytest.approx(BALL.centre, abs=1e-7)
    assert found.as_json()["status"] == found.status == ("undetermined" if len(found.others) else "converged")
    points = np.column_stack([TENSIONS, np.zeros(len(TENSIONS))])
    for centre in found.others:
        model = replace(ball, obstacle=replace(BALL, centre=tuple(centre)))
        answered = model.evaluate(points)
        off, error = np.abs(answered.contact_force - felt(ball)), answered.error["contact_force"]
        assert answered.inside.all() and error.min() > 5e-3 and (off < 3 * error).all()


def test_noise_moves_it_by_what_the_deviations_say(ball):
    random, noise, forces = np.random.default_rng(0), 5e-4, felt(ball)
    off = []
    for _ in range(40):
        found = find_object(away(ball, (5e-4, 0, 0)), TENSIONS, forces + noise * random.standard_normal(8), noise=noise)
        off.append((found.centre - BALL.centre) / found.deviations)
    assert 0.6 < np.std(off) < 1.5 and np.mean(np.abs(np.mean(off, axis=0))) < 0.5


def test_what_touches_cannot_decide_is_reported(finger, ball):
    plane = TouchedSegment(rod=finger, obstacle=facing_plane(rod.SIDE, (0.0, 0.05)))
    forces = plane.outputs(np.column_stack([TENSIONS, np.full(8, 4e-3)]))[:, 3]
    found = find_object(plane, TENSIONS, forces, 4e-3)
    assert found.status == "undetermined" and not np.isfinite(found.deviations).any()  # along it, it may be anywhere
    assert find_object(ball, TENSIONS, 50 * felt(ball), within=1e-3).status == "unreachable"


def test_a_touch_outside_the_model_is_reported(ball):
    """Forces beyond what was trained: the elements go on linearly, and what it finds is not to be relied on."""
    hard = 1.5 * TENSIONS
    found = ball.answers(np.column_stack([hard, np.zeros(len(hard))]))
    assert not found.inside.all()
    assert find_object(ball, hard, found.out[:, 3]).status == "out_of_domain"


def test_touches_that_are_none_are_refused(ball):
    for tensions, forces in ((TENSIONS[:2], [0.1, 0.1]), (TENSIONS, -felt(ball)), (TENSIONS[:, :1], felt(ball))):
        with pytest.raises(ValueError, match="must be"):
            find_object(ball, tensions, forces)
    with pytest.raises(ValueError, match="distances must be finite"):
        find_object(ball, TENSIONS, felt(ball), distances=np.nan)
