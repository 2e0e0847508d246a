"""Contact on the rubber: balance of forces, points on the object, derivatives, and continuity."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rom import Cylinder, Plane, Sphere, TouchedSegment, box
from rom.rod.compiled import reports
from rom.rod.compiled.touched import touches
from rom.rod.rod import Rod
from tests.rom.rod.outlined import rod_of
from tests.rom.rod.plates import touch_of_plates

SHAPES = ["plane", "sphere", "cylinder", "box"]


@pytest.fixture(scope="module")
def bundled() -> Rod:
    return TouchedSegment.load().rod


@pytest.fixture(scope="module", params=["square", "circle", "rounded square"])
def rod(request, bundled) -> Rod:
    return bundled if request.param == "square" else rod_of(request.param)


def pressed(rod: Rod, random: np.random.Generator, shape: str) -> tuple[TouchedSegment, np.ndarray]:
    """An object that presses on the rubber first, somewhere between clamp and tip, and a point at which it does."""
    while True:
        tensions, at = random.uniform(0, 70, len(rod.names)), random.uniform(0.4, 0.9)
        found = rod.sections(tensions, at=[at * rod.rest[0]])
        side = random.uniform(0, 2 * np.pi)
        out = found.rotations[0] @ [0.2 * random.standard_normal(), np.cos(side), np.sin(side)]
        out /= np.linalg.norm(out)
        radius, along = random.uniform(4e-3, 2e-2), np.cross(out, random.standard_normal(3))
        where = {"direction": tuple(out), "distances": (-0.1, 0.1)}
        centre = tuple(found.centres[0] + (radius + 0.02) * out)
        if shape == "plane":
            obstacle = Plane(centre=centre, normal=tuple(-out), **where)
        elif shape == "sphere":
            obstacle = Sphere(centre=centre, radius=radius, **where)
        elif shape == "cylinder":
            obstacle = Cylinder(centre=centre, radius=radius, axis=tuple(along), **where)
        else:
            turned = tuple(Rotation.random(random_state=random).as_rotvec())
            obstacle = box(centre=centre, sides=(radius, 0.01, 0.02), rotation=turned, rounding=1e-3, **where)
        model = TouchedSegment(rod=rod, obstacle=obstacle)
        touch = float(model.outputs([[*tensions, np.inf]])[0, 4])
        if np.isfinite(touch) and touch > touch_of_plates(model, np.array([*tensions, np.inf])) + 1e-3:
            point = np.array([*tensions, touch - random.uniform(1e-4, 1e-3)])
            if model.answers(point).inside[0]:
                return model, point


def load_wrenches(model: TouchedSegment, point: np.ndarray) -> np.ndarray:
    """Force and moment about the clamp's centre of all loads in space, shape (6,)."""
    rod, loads = model.rod, model.answers(point).loads[0]
    rows = loads.reshape(-1, 6)
    plates = len(rod.segments)
    sections = reports.elements(rod.struct, point[:-1], loads)
    places = np.concatenate([np.concatenate([one[0][:1] for one in sections]), *(one[0][1:] for one in sections)])
    turned = np.concatenate([np.concatenate([one[1][:1] for one in sections]), *(one[1][1:] for one in sections)])
    assert len(rows) == len(places) and plates <= len(rows)
    forces = np.einsum("kij,kj->ki", turned, rows[:, :3])
    moments = np.einsum("kij,kj->ki", turned, rows[:, 3:]) + np.cross(places, forces)
    return np.concatenate([forces.sum(axis=0), moments.sum(axis=0)])


@pytest.mark.parametrize("shape", SHAPES)
def test_loads_on_sections_are_the_contact_forces_where_they_are(rod, shape):
    """Beyond the last element before the clamp nothing goes to the ground: force and moment are equal."""
    random, compared = np.random.default_rng(1), 0
    for _ in range(12):
        model, point = pressed(rod, random, shape)
        contacts = model.contact_forces(point)
        assert any(one.rubber for one in contacts)
        force = sum(one.force for one in contacts)
        assert -force @ model.direction == pytest.approx(model.outputs(point[None])[0, 3], rel=1e-5)
        last = reports.elements(rod.struct, point[:-1], np.zeros((1, 6)))[0][0][-1]
        if min(np.linalg.norm(one.place) for one in contacts) < np.linalg.norm(last) + 2 * rod.half_lengths[1]:
            continue  # a part of it may go to the ground
        compared += 1
        moment = sum(np.cross(one.place, one.force) for one in contacts)
        found = load_wrenches(model, point)
        assert found[:3] == pytest.approx(force, abs=1e-4 * np.linalg.norm(force))
        assert found[3:] == pytest.approx(moment, abs=1e-4 * np.linalg.norm(force) * 0.05)
    assert compared > 3


@pytest.mark.parametrize("shape", ["plane", "sphere", "cylinder"])
def test_contacts_are_in_the_object_as_deep_as_rubber_yields_to_them(bundled, shape):
    """Every point is behind the surface along its normal, in the middle of what presses of its slice.

    The deepest of them is half as deep as the rubber, or more. A line presses where the mean of its gaps closes; slices
    are domed by up to 2e-3 of their thickness.
    """
    random = np.random.default_rng(2)
    for _ in range(8):
        model, point = pressed(bundled, random, shape)
        obstacle, depths = model.obstacle, []
        centre = np.array(obstacle.centre) + point[-1] * model.direction
        for one in model.contact_forces(point):
            arm = one.place - centre
            if isinstance(obstacle, Plane):
                gap, normal = float(arm @ obstacle.normal), np.array(obstacle.normal)
            else:
                if isinstance(obstacle, Cylinder):
                    axis = np.array(obstacle.axis) / np.linalg.norm(obstacle.axis)
                    arm = arm - (arm @ axis) * axis
                gap, normal = float(np.linalg.norm(arm) - obstacle.radius), arm / np.linalg.norm(arm)
            assert one.normal == pytest.approx(normal, abs=1e-6)
            assert -2e-3 < gap < 5e-5
            depths.append(-gap)
        deepest = -model.rubber_gap(point, model.answers(point).loads[0])
        assert max(depths) > 0.5 * deepest - 2e-6


@pytest.mark.parametrize("shape", SHAPES)
def test_derivatives_by_the_distance_are_those_of_the_answers(rod, shape):
    """But for how the surface changes its shape under the load, which the solve counts and the derivative does not.

    Beside the rounded edge of a box, the normal changes within the part of a slice that presses.
    """
    random, errors = np.random.default_rng(3), []
    for _ in range(9):
        model, point = pressed(rod, random, shape)
        step = np.array([0.0, 0.0, 1e-6])
        ahead, behind = model.outputs(np.array([point + step, point - step]))
        differences = (ahead - behind) / 2e-6
        found = model.jacobian(point)[:, -1]
        errors.append(abs(found[3] - differences[3]) / abs(differences[3]))
        assert found[:3] == pytest.approx(differences[:3], abs=0.1 * np.linalg.norm(differences[:3]))
    assert np.median(errors) < 0.02 and max(errors) < (0.15 if shape == "box" else 0.1)


@pytest.mark.parametrize("shape", SHAPES)
def test_the_force_begins_at_the_touch_distance_and_has_no_jump(rod, shape):
    random = np.random.default_rng(4)
    for _ in range(2):
        model, point = pressed(rod, random, shape)
        touch = float(model.outputs(point[None])[0, 4])
        steepest = []
        for count in (40, 400):  # of a jump, shorter steps would be steeper
            depths = np.array([0.0, 1e-9, 1e-7, *np.linspace(1e-6, touch - point[-1], count)])
            rows = np.column_stack([np.tile(point[:-1], (len(depths), 1)), touch - depths])
            answers = model.answers(rows)
            forces = answers.out[:, 3]
            assert forces[0] == 0.0 and forces[1] < 1e-4 and (answers.evaluations > 0).all()
            assert (np.diff(forces) > -1e-9).all()
            steepest.append(np.max(np.diff(forces[2:]) / np.diff(depths[2:])))
        assert steepest[1] < 1.5 * steepest[0]


def test_a_warm_start_on_the_rubber_finds_the_same_sooner(bundled):
    random = np.random.default_rng(5)
    for _ in range(5):
        model, point = pressed(bundled, random, "sphere")
        cold, moved = model.answers(point), point - [0.0, 0.0, 2e-5]
        near = touches(model.touching, moved[None], cold.loads)
        again = model.answers(moved)
        assert near.out == pytest.approx(again.out, rel=1e-5, abs=1e-9) and near.evaluations[0] <= again.evaluations[0]


def test_two_segments_are_pressed_between_their_plates(bundled):
    """The middle plate supports a part of what presses next to it: loads and contacts are in balance there too."""
    scene = bundled.scene | {"geometry": bundled.scene["geometry"] | {"segments": [0.04, 0.04]}}
    scene["tendons"] = [one | {"segment": 2, "tension": [0.0, 40.0]} for one in bundled.scene["tendons"]]
    rod = replace(bundled, scene=scene, accuracy={})
    found = rod.sections([10.0, 5.0], at=[0.046])
    out = found.rotations[0] @ [0.0, 1.0, 0.0]
    ball = Sphere(
        centre=tuple(found.centres[0] + 0.03 * out), radius=0.006, direction=tuple(out), distances=(-0.1, 0.1)
    )
    model = TouchedSegment(rod=rod, obstacle=ball)
    point = np.array([10.0, 5.0, float(model.outputs([[10.0, 5.0, np.inf]])[0, 4]) - 1e-3])
    answer, contacts = model.answers(point), model.contact_forces(point)
    force = sum(one.force for one in contacts)
    assert answer.inside[0] and all(one.rubber and one.plate == 1 for one in contacts)
    total = load_wrenches(model, point)
    assert total[:3] == pytest.approx(force, abs=1e-5 * np.linalg.norm(force))
    assert total[3:] == pytest.approx(
        sum(np.cross(one.place, one.force) for one in contacts), abs=1e-5 * np.linalg.norm(force) * 0.08
    )
    assert np.abs(answer.loads[0].reshape(-1, 6)[0]).max() > 0  # the middle plate's


def test_estimated_errors_count_the_surface_and_the_indentation(bundled):
    """An estimate of a force on rubber counts the surface's error times the stiffness."""
    model, point = pressed(bundled, np.random.default_rng(6), "sphere")
    answer, slope = model.evaluate(point), abs(float(model.jacobian(point)[3, -1]))
    assert answer.error["contact_force"] > slope * bundled.errors.surface
    assert answer.error["touch_distance"] > bundled.errors.surface


def test_a_ball_that_grazes_a_hollow_face_touches_where_the_gap_closes(bundled):
    """Between its edges the face lies deeper than they do, so touch is later than on a flat one."""
    ball = Sphere(centre=(0.046, 0.031, 0.001), radius=0.026, direction=(0.0, 1.0, 0.0), distances=(-0.05, 0.05))
    model = TouchedSegment(rod=bundled, obstacle=ball)
    for tensions in ([72.7, 100.0], [100.0, 100.0], [60.0, 100.0]):
        touch = float(model.outputs([[*tensions, np.inf]])[0, 4])
        gaps = [model.rubber_gap(np.array([*tensions, touch + way]), np.zeros((1, 6))) for way in (-1e-5, 0.0, 1e-5)]
        assert gaps[0] < 0 < gaps[2] and abs(gaps[1]) < 1e-9


@pytest.mark.parametrize(("size", "modulus"), [(0.3, 10.0), (6.0, 0.1)])
def test_contact_on_rubber_is_similar_at_another_size_and_modulus(bundled, size, modulus):
    """Forces go with modulus times size squared, places with size."""
    random, force = np.random.default_rng(7), modulus * size**2
    scene = {name: bundled.scene[name] for name in ("geometry", "material", "tendons")}
    geometry = {name: scene["geometry"][name] for name in ("side", "plate")}
    material = {"law": "neo-hookean", "C1": 1.9e6 * modulus, "D1": 2.43e-7 / modulus}
    tendons = [
        one | {"offset": [size * x for x in one["offset"]], "tension": [force * x for x in one["tension"]]}
        for one in scene["tendons"]
    ]
    lengths = {name: size * value for name, value in geometry.items()} | {"segments": [0.05 * size], "channel": None}
    other = replace(
        bundled, scene=bundled.scene | {"geometry": lengths, "material": material, "tendons": tendons}, accuracy={}
    )
    for _ in range(6):
        model, point = pressed(bundled, random, "sphere")
        ball = model.obstacle
        scaled = replace(
            ball,
            centre=tuple(size * np.array(ball.centre)),
            radius=size * ball.radius,
            distances=(-0.1 * size, 0.1 * size),
        )
        found = TouchedSegment(rod=other, obstacle=scaled).outputs([[*force * point[:-1], size * point[-1]]])[0]
        expected = model.outputs(point[None])[0] * [size, size, size, force, size]
        assert found == pytest.approx(expected, rel=1e-5, abs=1e-9 * size)


@pytest.mark.parametrize("radius", [1e-6, 1e-4, 1e-3, 0.1, 10.0, 1e4])
def test_a_ball_of_any_size_touches_where_it_meets_the_face_and_none_passes_into_it_unmarked(bundled, radius):
    where = {"centre": (0.025, 0.006 + radius, 0.0), "direction": (0.0, 1.0, 0.0), "distances": (-1.0, 1.0)}
    model = TouchedSegment(rod=bundled, obstacle=Sphere(radius=radius, **where))
    answer = model.answers([0.0, 0.0, -0.0012])
    assert answer.out[0, 4] == pytest.approx(-0.001, abs=3e-5)
    assert not answer.inside[0] or 0.1 < answer.out[0, 3] < 40.0
    assert answer.inside[0] == (radius >= 1e-3)
