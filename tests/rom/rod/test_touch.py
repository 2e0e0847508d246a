"""Contact of a plate and rigid objects: forces only where gaps are closed, derivatives, and what has no answer."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import lsq_linear, nnls
from scipy.spatial.transform import Rotation

from control import Finger
from rom import Cylinder, Hull, Plane, Sphere, TouchedSegment, box
from rom.rod.objects.shapes import facing_plane
from tests.rom.elements import elastic_rod as rod
from tests.rom.rod.plates import bare, touch_of_plates

MOST_FORCE = 1.0  # that elements of the rod were trained with [N]


def touched(finger, random: np.random.Generator, shape: str) -> tuple[TouchedSegment, np.ndarray]:
    """The finger and an object before its plate, turned and placed at random; and a point at which it touches.

    The plate alone can be touched.
    """
    finger = bare(finger)
    tensions = rod.MOST_TENSION * random.random(2)
    free = finger.place(tensions)
    centre, rotation = free.centres[0], free.rotations[0]
    axis = rotation[:, 0]
    normal = random.standard_normal(3)
    normal -= max(normal @ axis, 0.0) * 1.2 * axis
    normal /= np.linalg.norm(normal)
    places = centre + rod.CORNERS @ rotation.T
    place = places[np.argmin(places @ normal)]
    where = {"direction": tuple(-normal), "distances": (-0.01, 0.01)}
    radius = 10 ** random.uniform(-2.5, -1.3)
    if shape == "plane":
        found = Plane(centre=tuple(place), normal=tuple(normal), **where)
    elif shape == "sphere":
        found = Sphere(centre=tuple(place - radius * normal), radius=radius, **where)
    elif shape == "hull":
        vertices = random.standard_normal((12, 3))
        vertices *= radius / np.linalg.norm(vertices, axis=1)[:, None]
        found = Hull(centre=tuple(place - radius * normal), vertices=vertices, **where)
        model = TouchedSegment(rod=finger, obstacle=found)
        touch = touch_of_plates(model, [*tensions, 0.0])
        if not touch > -0.009:  # its corners pass the plate by
            return touched(finger, random, shape)
        return model, np.array([*tensions, touch - 5e-4 * random.random()])
    else:
        along = np.cross(normal, random.standard_normal(3))
        found = Cylinder(centre=tuple(place - radius * normal), radius=radius, axis=tuple(along), **where)
    return TouchedSegment(rod=finger, obstacle=found), np.array([*tensions, -5e-4 * random.random()])


def test_corners_that_press_on_a_plane_lie_on_it_and_no_other_is_behind_it(finger):
    random, known = np.random.default_rng(1), 0
    for _ in range(40):
        model, point = touched(finger, random, "plane")
        found = model.answers(point)
        if not found.inside[0]:  # forces beyond what was trained
            continue
        known += 1
        # By another way than the solve: the rod itself under the wrench that was found.
        centre, turned = rod.plate(point[:2], found.wrenches[0])
        plane: Plane = model.obstacle
        moved = np.array(plane.centre) + point[2] * np.array(plane.direction)
        gaps = (centre + rod.CORNERS @ turned.T - moved) @ plane.normal
        force = turned @ found.wrenches[0, :3]
        assert np.cross(force, plane.normal) == pytest.approx(np.zeros(3), abs=1e-4 * found.out[0, 3])
        assert found.out[0, 3] == pytest.approx(force @ plane.normal, rel=1e-5) and found.out[0, 3] > 0
        assert abs(gaps.min()) < 2e-6  # as far as the elements are the rod
        arms = np.cross(rod.CORNERS, turned.T @ plane.normal).T  # corners that push alone make this wrench
        wanted = [rod.SIDE * found.out[0, 3], *found.wrenches[0, 3:]]
        pushing, left = nnls(np.vstack([np.full(8, rod.SIDE), arms]), np.array(wanted))
        assert left < 1e-6 * found.out[0, 3] and (pushing >= 0).all()
    assert known > 28


def separation(one: np.ndarray, other: np.ndarray) -> float:
    """Distance of two convex hulls, corners of shapes (n, 3) and (m, 3): of the hull of all differences from 0.

    Among all weights t w with sum(w) = 1, the ones nearest to |t P w|^2 + (t - 1)^2 = 0 have the least |P w|.
    (nnls of SciPy 1.15 stops too early here.)
    """
    differences = (one[:, None] - other).reshape(-1, 3).T
    size = np.abs(differences).min(axis=1).max() + 1e-4
    sums = np.vstack([differences / size, np.ones(differences.shape[1])])
    weights = lsq_linear(sums, np.eye(4)[3], (0.0, np.inf), method="bvls", tol=1e-14, max_iter=1000).x
    return float(np.linalg.norm(differences @ weights) / weights.sum())


def test_a_hull_that_presses_touches_the_plate_and_does_not_cut_it(finger):
    """By another way than the solve: the distance of the two bodies, and where the force's line of action passes."""
    random, known = np.random.default_rng(6), 0
    for _ in range(150):
        model, point = touched(finger, random, "hull")
        found, hull = model.answers(point), model.obstacle
        if not found.inside[0]:
            continue
        known += 1
        placed, free = finger.place(point[:2], found.wrenches), finger.place(point[:2])
        moved = np.array(hull.centre) + point[2] * np.array(hull.direction)
        at_touch = np.array(hull.centre) + touch_of_plates(model, point) * np.array(hull.direction)
        for plate, place in ((placed, moved), (free, at_touch)):
            distance = separation(
                plate.centres[0] + rod.CORNERS @ plate.rotations[0].T, np.array(hull.vertices) + place
            )
            assert distance == pytest.approx(hull.rounding, abs=1e-7)
        assert found.out[0, 3] > 0
        point_of_action = np.cross(found.wrenches[0, :3], found.wrenches[0, 3:]) / np.sum(found.wrenches[0, :3] ** 2)
        assert np.linalg.norm(point_of_action) <= np.linalg.norm(rod.HALF) * (1 + 1e-6)
    assert known > 80


def test_a_box_that_lies_flush_is_the_plane_of_its_face(finger):
    """Larger than the plate, and turned about the plane's normal, so that no edges are along each other."""
    plane = facing_plane(rod.SIDE, (0.0, 0.05))
    cube = box(
        centre=(0.03, rod.SIDE / 2 + 0.05, 0.0),
        sides=(0.1, 0.1, 0.1),
        direction=(0, 1, 0),
        rotation=(0.0, 0.3, 0.0),
        distances=(0.0, 0.05),
    )
    points = np.array([[6.0, 1.0, 0.01], [10.0, 0.0, 0.01], [10.0, 3.0, 0.01]])
    points[:, 2] = TouchedSegment(rod=finger, obstacle=plane).outputs(points)[:, 4] - 8e-4
    flat, boxed = (TouchedSegment(rod=finger, obstacle=one).outputs(points) for one in (plane, cube))
    assert boxed == pytest.approx(flat, rel=1e-6, abs=1e-9) and (flat[:, 3] > 0.1).all()


@pytest.mark.parametrize("shape", ["plane", "sphere", "cylinder", "hull"])
def test_forces_at_the_contact_points_make_the_wrench(finger, shape):
    random, known = np.random.default_rng(8), 0
    for _ in range(30):
        model, point = touched(finger, random, shape)
        answer = model.answers(point)
        if not answer.inside[0]:
            continue
        known += 1
        found = model.contact_forces(point)
        placed = finger.place(point[:2], answer.wrenches)
        force = sum((one.force for one in found), np.zeros(3))
        moment = sum((np.cross(one.place - placed.centres[0], one.force) for one in found), np.zeros(3))
        expected = placed.rotations[0] @ answer.wrenches[0].reshape(2, 3).T
        size = np.linalg.norm(force)
        assert force == pytest.approx(expected[:, 0], abs=1e-5 * size) and size > 0
        assert moment == pytest.approx(expected[:, 1], abs=1e-5 * size * rod.SIDE)
        assert all(one.force @ one.normal > 0 for one in found) and len(found) <= 8
    assert known > 10
    free = np.array([*point[:2], 0.5])
    assert model.contact_forces(free) == []
    nearest = replace(model, obstacle=replace(model.obstacle, distances=(float(point[2]), 1.0)))
    beyond = nearest.contact_forces(point - np.array([0.0, 0.0, 1e-3]))  # as at the nearest d, where it is answered
    assert len(beyond) == len(model.contact_forces(point))


def moved(model: TouchedSegment, way: np.ndarray) -> TouchedSegment:
    """The same before the object moved."""
    return replace(model, obstacle=replace(model.obstacle, centre=tuple(np.array(model.obstacle.centre) + way)))


def turned(model: TouchedSegment, way: np.ndarray) -> TouchedSegment:
    """The same before the object turned about its centre by a rotation vector [rad]."""
    rotation, obstacle = Rotation.from_rotvec(way), model.obstacle
    own = {
        name: tuple(rotation.apply(getattr(obstacle, name))) for name in ("normal", "axis") if hasattr(obstacle, name)
    }
    if isinstance(obstacle, Hull):
        own = {"vertices": rotation.apply(obstacle.vertices)}
    return replace(model, obstacle=replace(obstacle, **own))


def _direction(model: TouchedSegment) -> np.ndarray:
    return np.array(model.obstacle.numbers()["direction"])


@pytest.mark.parametrize("shape", ["plane", "sphere", "cylinder", "hull"])
def test_derivatives_are_those_of_the_answers(finger, shape):
    random, off = np.random.default_rng(2), 5e-4
    for _ in range(30):
        model, point = touched(finger, random, shape)
        value, jacobian = model.value_and_jacobian(point)
        by_object = model.answers(point, by_object=True).by_object[0]
        if not model.evaluate(point).inside or not value[3] > 5e-3:  # solved to 1e-7 of the largest force
            continue
        for k, h in enumerate((2e-4, 2e-4, 2e-8)):
            unit = h * np.eye(3)[k]
            after, before = model.outputs(point + unit)[0], model.outputs(point - unit)[0]
            differences = (after - before) / (2 * h)
            assert jacobian[:, k] == pytest.approx(differences, rel=off, abs=off * np.abs(differences[:3]).max())
        assert by_object[:4, :3] @ _direction(model) == pytest.approx(jacobian[:4, 2], rel=1e-9)
        assert by_object[4, :3] @ _direction(model) == pytest.approx(-1.0)
        for k in range(6):
            way, h, axes = (moved, 2e-8, slice(3)) if k < 3 else (turned, 2e-6, slice(3, 6))
            after, before = (way(model, step * np.eye(3)[k % 3]).outputs(point)[0] for step in (h, -h))
            differences = (after - before) / (2 * h)
            near = off * np.abs(by_object[:3, axes]).max() + 1e-12
            assert by_object[:, k] == pytest.approx(differences, rel=off, abs=near)


@pytest.mark.parametrize("shape", ["plane", "sphere", "cylinder", "hull"])
def test_every_answer_is_known_or_says_that_it_is_not(finger, shape):
    random = np.random.default_rng(3)
    unknown = 0
    for _ in range(300):
        model, point = touched(finger, random, shape)
        found, answer = model.answers(point), model.evaluate(point)
        assert np.isfinite(found.out).all() and abs(found.evaluations[0]) < 1000
        if found.evaluations[0] < 0:
            assert not answer.inside and answer.error["contact_force"] == np.inf
            unknown += 1
        else:
            assert found.out[0, 3] >= 0
    assert unknown <= 15


def test_a_small_ball_is_a_point_and_a_large_one_a_plane(finger):
    """Before a plate that stands flush, what a ball of infinite radius does is what a plane through it does."""
    normal, centre = (0.0, -1.0, 0.0), np.array([rod.LENGTH - rod.PLATE / 2, rod.SIDE / 2, 0.0])
    pressed = np.array([10.0, 0.0, 1e-3])
    flat = TouchedSegment(
        rod=finger,
        obstacle=Plane(centre=tuple(centre), normal=normal, direction=(0, 1, 0), distances=(0.0, 0.05)),
    )
    radius = 100.0
    ball = TouchedSegment(
        rod=finger,
        obstacle=Sphere(
            centre=(centre[0], centre[1] + radius, 0.0), radius=radius, direction=(0, 1, 0), distances=(0.0, 0.05)
        ),
    )
    assert ball.outputs(pressed)[0, 3] == pytest.approx(flat.outputs(pressed)[0, 3], rel=1e-2)


def test_a_finger_holds_and_locates_whatever_it_touches(finger):
    plane = TouchedSegment(rod=finger, obstacle=facing_plane(rod.SIDE, (0.0, 0.05)))
    ball = TouchedSegment(
        rod=finger,
        obstacle=Sphere(centre=(0.046, 0.015, 0.002), radius=0.008, direction=(0, 1, 0), distances=(-0.01, 0.02)),
    )
    for model, distance in ((plane, 0.006), (ball, 0.001)):
        own = Finger(model)
        held = own.hold(0.5, distance)
        assert held.converged and model.outputs([*held.tensions, distance])[0, 3] == pytest.approx(0.5, abs=1e-6)
        assert own.locate(held.tensions, 0.5).distance == pytest.approx(distance, abs=1e-6)
    assert Finger(plane).reach(finger.rest, tolerance=1e-5).converged


def test_an_object_beside_the_finger_is_found_where_it_can_be_pressed(finger):
    """The free finger passes it by where it is at rest: no slope leads there, but the atlas does."""
    ball = Sphere(centre=(0.043, 0.012, 0.016), radius=0.005, direction=(0, 1, 0), distances=(-0.01, 0.02))
    model = TouchedSegment(rod=finger, obstacle=ball)
    assert model.outputs([0.0, 0.0, 0.0])[0, 4] == -np.inf
    held = Finger(model).hold(0.2, 0.0, start=[0.0, 0.0])
    assert held.converged and model.outputs([*held.tensions, 0.0])[0, 3] == pytest.approx(0.2, abs=1e-6)


def test_an_object_in_the_clamp_is_noticed(finger):
    """A plane that the tip touches, and that the clamp stands behind: nothing could be held so."""
    normal = np.array([-0.3, -1.0, 0.0]) / np.linalg.norm([-0.3, -1.0, 0.0])
    corner = finger.rest + rod.HALF
    for turned, inside in ((normal, True), (normal * [-1, 1, 1], False)):
        plane = Plane(centre=tuple(corner), normal=tuple(turned), direction=tuple(-turned), distances=(-0.01, 0.01))
        model = TouchedSegment(rod=finger, obstacle=plane)
        assert bool(model.evaluate([0.0, 0.0, -1e-5]).inside) == inside


@pytest.mark.long
def test_a_finger_that_ends_at_a_kink_has_converged_if_it_holds_the_force(finger):
    """A ball rolls from the plate's face over its edge: the force has a kink there, and steps along it end."""
    for height in np.linspace(0.0495, 0.055, 3):
        ball = Sphere(centre=(height, 0.021, 0.0), radius=0.012, direction=(0, 1, 0), distances=(-0.01, 0.02))
        model = TouchedSegment(rod=finger, obstacle=ball)
        held = Finger(model).hold(0.5, 0.0)
        assert held.converged and model.outputs([*held.tensions, 0.0])[0, 3] == pytest.approx(0.5, abs=2e-6)


def test_forces_beyond_what_was_trained_are_marked(finger):
    plane = TouchedSegment(rod=finger, obstacle=facing_plane(rod.SIDE, (0.0, 0.05)))
    hard = plane.evaluate([rod.MOST_TENSION, 0.0, 1e-4])
    assert hard.contact_force > MOST_FORCE and not hard.inside
    assert Finger(plane).hold(1.5 * MOST_FORCE, 1e-3).status == "out_of_domain"


def test_a_plate_that_would_slip_off_a_ball_is_marked(finger):
    """Its corner rests on a large ball, and beside the tip of a small one no longer."""
    slanted = np.array([1.0, 0.2, 0.2]) / np.linalg.norm([1.0, 0.2, 0.2])
    found = []
    for radius, depth in ((0.02, 1e-4), (3e-4, 2e-4)):
        centre = finger.rest + rod.HALF + radius * slanted
        ball = Sphere(centre=tuple(centre), radius=radius, direction=tuple(slanted), distances=(-0.01, 0.0))
        answer = TouchedSegment(rod=finger, obstacle=ball).answers(np.array([0.0, 0.0, -depth]))
        assert 0 < answer.out[0, 3] < MOST_FORCE
        found.append(bool(answer.inside[0]))
    assert found == [True, False]


AHEAD = rod.LENGTH
OBJECTS = {
    "plane": Plane(centre=(AHEAD, 0, 0), normal=(-1, 0, 0), direction=(1, 0, 0)),
    "sphere": Sphere(centre=(AHEAD + 0.01, 0, 0), radius=0.01, direction=(1, 0, 0)),
    "cylinder": Cylinder(centre=(AHEAD + 0.01, 0, 0), radius=0.01, axis=(0, 0, 1), direction=(1, 0, 0)),
    "hull": box(centre=(AHEAD + 0.01, 0, 0), sides=(0.02, 0.02, 0.02), direction=(1, 0, 0)),
}


@pytest.mark.parametrize("shape", OBJECTS)
def test_an_object_ahead_of_the_straight_finger_compresses_it(finger, shape):
    model, pushed = TouchedSegment(rod=finger, obstacle=OBJECTS[shape]), 4e-5  # [m]
    found = model.evaluate([0.0, 0.0, -pushed])
    assert found.contact_force == pytest.approx(rod.AXIAL / (rod.LENGTH - rod.PLATE) * pushed, rel=0.02)
    assert found.tip == pytest.approx([-pushed, 0, 0], abs=0.02 * pushed)
    assert model.evaluate([0.0, 0.0, pushed]).contact_force == 0.0


# Boxes that a corner of the plate enters by one side and might leave by another: tensions [N], direction, centre, sides
# [m], rotation, and rounding [m].
ENTERED = [
    (
        (74, 39),
        (0.946, 0.158, 0.282),
        (-0.0424, 0.0141, -0.0125),
        (0.0244, 0.0259, 0.026),
        (0.731, 2.335, -0.225),
        9e-4,
    ),
    (
        (16, 49),
        (0.088, 0.993, 0.073),
        (0.0339, -0.0717, 0.0125),
        (0.0142, 0.0275, 0.0127),
        (0.746, 2.854, 0.431),
        1.3e-3,
    ),
    (
        (48, 0.4),
        (0.445, 0.771, -0.455),
        (0.0044, -0.0471, 0.0353),
        (0.0241, 0.0087, 0.0222),
        (-0.03, -1.138, 1.052),
        6e-4,
    ),
    (
        (33, 31),
        (0.567, 0.136, 0.813),
        (-0.0052, -0.0009, -0.0472),
        (0.0287, 0.0223, 0.0292),
        (-0.102, 0.786, 2.357),
        1.2e-3,
    ),
]


@pytest.mark.parametrize("entered", ENTERED)
def test_a_corner_deep_in_a_box_leaves_it_by_the_side_where_it_entered(entered):
    """The force has no jump as the box comes nearer, though every contact is solved from nothing."""
    tensions, direction, centre, sides, rotation, rounding = entered
    obstacle = box(
        centre=centre, sides=sides, rotation=rotation, rounding=rounding, direction=direction, distances=(0.0, 0.15)
    )
    model = TouchedSegment(rod=TouchedSegment.load().rod, obstacle=obstacle)
    touch = model.outputs(np.array([[*tensions, 0.15]]))[0, 4]
    answers = model.answers(np.column_stack([np.tile(tensions, (61, 1)), touch - np.linspace(0, 4e-3, 61)]))
    forces = answers.out[answers.inside, 3]
    assert len(forces) > 40
    assert np.abs(np.diff(forces, 2)).max() < 0.1 * forces.max()


@pytest.mark.parametrize("radius", [1e-9, 1e-6, 1e-3, 1.0, 1e3])
def test_a_ball_of_any_size_deep_in_the_plate_takes_a_bounded_number_of_evaluations(radius):
    """Steps of the approach are limited by the radius, but not without end."""
    finger = TouchedSegment.load().rod
    ball = Sphere(centre=(0.04, -radius, 0.0), radius=radius, direction=(0, 1, 0), distances=(-0.1, 0.1))
    model = TouchedSegment(rod=finger, obstacle=ball)
    answers = model.answers(np.array([40.0, 10.0, model.outputs(np.array([[40.0, 10.0, 0.1]]))[0, 4] - 3e-3]))
    assert 0 < np.abs(answers.evaluations[0]) < 1000
