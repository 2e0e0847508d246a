"""The rubber of a finger of elements before objects: its gaps, and where the free finger is touched first."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from control import Finger
from rom import Cylinder, Hull, Plane, Sphere, TouchedSegment
from rom.rod.rod import Rod
from tests.rom.elements import elastic_rod
from tests.rom.elements.elastic_rod import PLATE, SQUARE, corners_at
from tests.rom.rod.plates import touch_of_plates

POINTS = 4000
STEP = 1e-4  # [N]
NEAR = 3e-6  # how near the assembled surface is to the elastic rod's [m]


@pytest.fixture(scope="module")
def shipped() -> TouchedSegment:
    return TouchedSegment.load()


@pytest.fixture(scope="module")
def points(shipped) -> np.ndarray:
    lower, upper = shipped.limits
    return lower + (upper - lower) * np.random.default_rng(0).random((POINTS, len(lower)))


def test_the_rubber_s_gap_is_the_elastic_rod_s(finger):
    """Planes and balls, under wrenches on the plate; at the sections between clamp and plate."""
    random, inputs = np.random.default_rng(4), 0.5 * elastic_rod.pressed(12, 7)
    rubber = 0.050 - PLATE
    at = np.linspace(0.0, rubber, finger.segments[0].struct.places)[:-1]
    for row, corners in zip(inputs, corners_at(inputs, 0.050, at), strict=True):
        side = random.standard_normal(3) * [0.3, 1.0, 1.0]
        side /= np.linalg.norm(side)
        middle = corners[random.integers(5, len(corners))].mean(axis=0)
        where = {"centre": tuple(middle + 0.03 * side), "direction": tuple(side), "distances": (-0.05, 0.05)}
        faces = corners[:, [0, 1, 3, 2]]
        shares = np.linspace(0.0, 1.0, 9)[:, None, None, None]
        on_faces = faces + shares * (np.roll(faces, -1, axis=1) - faces)
        for obstacle, gaps in (
            (Plane(normal=tuple(-side), **where), (middle + 0.03 * side - corners) @ side),
            (Sphere(radius=0.011, **where), np.linalg.norm(on_faces - middle - 0.03 * side, axis=-1) - 0.011),
        ):
            model = TouchedSegment(rod=finger, obstacle=obstacle)
            near = NEAR if isinstance(obstacle, Plane) else 3 * NEAR  # the points here are of flat faces
            assert abs(model.rubber_gap([*row[:2], 0.0], row[None, 2:]) - gaps.min()) < near


def test_every_answer_has_one_touch_distance(shipped, points):
    answers, outputs = shipped.evaluate(points), shipped.outputs(points)
    alone = np.array([touch_of_plates(shipped, point) for point in points])
    rubber_first = outputs[:, 4] > alone
    assert 0.01 < rubber_first.mean() < 0.1 and (outputs[:, 4] >= alone).all()
    assert np.array_equal(answers.touch_distance, outputs[:, 4])
    assert np.array_equal(shipped.answers(points).out, outputs)
    for i in [*np.flatnonzero(rubber_first)[:20], *range(20)]:
        assert shipped.value_and_jacobian(points[i])[0][4] == outputs[i, 4]


def test_its_derivative_is_that_of_the_answers(shipped, points):
    lower, upper = (end[:-1] for end in shipped.limits)
    inner = np.clip(points, [*(lower + STEP), -np.inf], [*(upper - STEP), np.inf])
    slopes = shipped.answers(inner).jacobians[:, 4]
    for k in range(len(lower)):
        unit = STEP * np.eye(3)[k]
        after, before = shipped.outputs(inner + unit)[:, 4], shipped.outputs(inner - unit)[:, 4]
        here = shipped.outputs(inner)[:, 4]
        smooth = np.abs(after - 2 * here + before) < 1e-10  # no other point comes to touch first in between
        assert smooth.mean() > 0.95
        differences = (after - before) / (2 * STEP)
        assert slopes[smooth, k] == pytest.approx(differences[smooth], abs=1e-6 * np.abs(differences).max())
    assert np.array_equal(slopes[:, -1], np.zeros(POINTS))


def test_reach_stays_clear_of_the_plane_with_the_rubber_too(shipped, points):
    finger, free = Finger(shipped), points.copy()
    free[:, -1] = np.inf
    reaches, alone = shipped.outputs(free), np.array([touch_of_plates(shipped, point) for point in free])
    some = np.flatnonzero((reaches[:, 4] > alone + 1e-6) & (reaches[:, 4] > 2e-5))
    assert len(some) > 40
    for i in some:
        for share in (0.2, 0.9):  # of the way by which the rubber is ahead of the plate
            distance = max(float(alone[i] + share * (reaches[i, 4] - alone[i])), 0.0)
            motion = finger.reach(finger.rest + reaches[i, :3], distance, start=points[i, :-1])
            assert shipped.evaluate([*motion.tensions, np.inf]).touch_distance <= distance + 1e-12
            clear = reaches[:, 4] <= distance
            nearest = np.linalg.norm(reaches[clear, :3] - reaches[i, :3], axis=1).min(initial=np.inf)
            assert motion.residual <= nearest + 2e-4


def in_the_way(rod: Rod, random: np.random.Generator, shape: str) -> tuple[TouchedSegment, np.ndarray]:
    """An object of a shape that comes to the middle of the rubber from a random side, and tensions."""
    tensions, side = 0.3 * elastic_rod.MOST_TENSION * random.random(2), random.uniform(0, 2 * np.pi)
    out = np.array([0.2 * random.standard_normal(), np.cos(side), np.sin(side)])
    out /= np.linalg.norm(out)
    along, radius = np.cross(out, random.standard_normal(3)), random.uniform(2e-3, 1e-2)
    where = {
        "centre": tuple(np.array([random.uniform(0.015, 0.03), 0.0, 0.0]) + 0.02 * out),
        "direction": tuple(out + 0.2 * random.standard_normal(3)),
        "distances": (-0.05, 0.05),
    }
    if shape == "plane":
        found = Plane(normal=tuple(-out), **where)
    elif shape == "sphere":
        found = Sphere(radius=radius, **where)
    elif shape == "cylinder":
        found = Cylinder(radius=radius, axis=tuple(along), **where)
    else:
        vertices = random.standard_normal((12, 3))
        found = Hull(vertices=radius * vertices / np.linalg.norm(vertices, axis=1)[:, None], **where)
    return TouchedSegment(rod=rod, obstacle=found), tensions


@pytest.mark.parametrize("shape", ["plane", "sphere", "cylinder", "hull"])
def test_at_the_touch_distance_the_rubber_has_no_gap_and_before_it_has_one(finger, shape):
    random, counted = np.random.default_rng(1), 0
    for _ in range(60):
        model, tensions = in_the_way(finger, random, shape)
        free = np.array([*tensions, np.inf])
        touch, alone = model.outputs(free)[0, 4], touch_of_plates(model, free)
        assert touch >= alone
        if not (touch > alone and np.isfinite(touch) and abs(touch) < 0.05):
            continue
        counted += 1
        gaps = [model.rubber_gap(np.array([*tensions, touch + way]), np.zeros((1, 6))) for way in (-1e-6, 0.0, 1e-6)]
        assert abs(gaps[1]) < 1e-10 and gaps[0] < gaps[1] < gaps[2]
        ahead = np.linspace(touch + 1e-4, 0.05, 30)
        assert min(model.rubber_gap(np.array([*tensions, d]), np.zeros((1, 6))) for d in ahead) > 0
        found = model.answers(free, by_object=True)
        for k in range(2):
            unit = STEP * np.eye(3)[k]
            after, before = model.outputs(free + unit)[0, 4], model.outputs(free - unit)[0, 4]
            if abs(after - 2 * touch + before) < 1e-9:
                assert found.jacobians[0, 4, k] == pytest.approx((after - before) / (2 * STEP), rel=1e-3, abs=1e-8)
        for k in range(3):
            h, centre = 1e-7, np.array(model.obstacle.centre)
            places = [replace(model.obstacle, centre=tuple(centre + step * np.eye(3)[k])) for step in (h, -h)]
            after, before = (replace(model, obstacle=one).outputs(free)[0, 4] for one in places)
            if abs(after - 2 * touch + before) < 1e-10:
                assert found.by_object[0, 4, k] == pytest.approx((after - before) / (2 * h), rel=1e-3, abs=1e-5)
    assert counted > 20


def test_an_object_that_the_clamp_s_end_of_the_rubber_meets_first_is_noticed(finger):
    """The plane leans towards the clamp, which no tension moves."""
    turned = Rotation.from_rotvec([0, 0, 0.6]).apply([0.0, -1.0, 0.0])
    plane = Plane(centre=(0.0, 0.02, 0.0), normal=tuple(turned), direction=(0, 1, 0), distances=(-0.02, 0.05))
    model = TouchedSegment(rod=finger, obstacle=plane)
    value, jacobian = model.value_and_jacobian([1.0, 1.0, np.inf])
    gaps = (SQUARE - plane.centre) @ turned
    assert value[4] == pytest.approx(gaps.min() / turned[1], abs=1e-9)
    assert jacobian[4] == pytest.approx(np.zeros(3), abs=1e-15)
