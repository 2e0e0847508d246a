"""Report of a finger besides its answer: the tip's orientation and the tendons' shortenings, with derivatives."""

import numpy as np
import pytest
from assembled import in_series, scaled, two_segments

from rom import TouchedSegment
from rom.elements import rotation_vectors
from rom.elements.march import march
from rom.rod.compiled import reports
from rom.rod.objects.shapes import Sphere, facing_plane

TENSIONS, DEPTH = (20.0, 6.0), 0.001  # [N], [m]
STEPS = np.array([1e-3, 1e-3, 1e-6])  # of two tensions [N] and d [m]
SOLVED = 1e-6  # by which the last step of a solve may move plates [m, -]
ROUGH = 1e-3  # of derivatives in contact, as those of the tip have it, over the largest by an input [-]


def short_tendon() -> TouchedSegment:
    """Two segments, of which one tendon ends at the first plate, before a ball beside that plate."""
    bundled = TouchedSegment.load().rod
    geometry = bundled.scene["geometry"] | {"segments": [0.04, 0.05]}
    tendons = [one | {"segment": 2 - k} for k, one in enumerate(bundled.scene["tendons"])]
    rod = bundled.assembled(bundled.scene | {"geometry": geometry, "tendons": tendons})
    plates, radius = rod.place(TENSIONS), 0.002
    away = plates.rotations[0][:, 1]
    centre = plates.centres[0] + (rod.half_lengths[1] + radius) * away
    ball = Sphere(centre=tuple(centre), radius=radius, direction=tuple(away), distances=(-1.0, 1.0))
    return TouchedSegment(rod=rod, obstacle=ball)


MODELS = {"bundled": TouchedSegment.load, "two segments": two_segments, "short tendon": short_tendon}
EACH = pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)


def in_contact(model: TouchedSegment) -> np.ndarray:
    """A point where the object presses on a plate, DEPTH past the touch distance."""
    free = model.outputs(np.array([[*TENSIONS, np.inf]]))[0]
    return np.array([*TENSIONS, free[4] - DEPTH])


def by_differences(model: TouchedSegment, point: np.ndarray) -> np.ndarray:
    """Derivatives of quaternion and shortenings, shape (4 + t, p)."""
    columns = []
    for k, step in enumerate(STEPS):
        ahead, behind = (model.evaluate(point + sign * step * np.eye(3)[k]) for sign in (1, -1))
        one, other = (np.concatenate([answer.orientation, answer.shortenings]) for answer in (ahead, behind))
        columns.append((one - other) / (2 * step))
    return np.array(columns).T


@EACH
@pytest.mark.parametrize("touches", [False, True])
def test_derivatives_are_those_of_differences(model, touches):
    model = model()
    point = in_contact(model)
    if not touches:
        point[-1] += 0.01
    answer, report = model.evaluate(point), model.report(point)
    assert answer.inside and (answer.contact_force > 0.01) == touches
    found = np.vstack([report.orientation_jacobian, report.shortening_jacobian])
    expected = by_differences(model, point)
    scale = np.abs(expected).max(axis=0) + 1e-9
    assert found / scale == pytest.approx(expected / scale, abs=ROUGH)
    assert np.any(expected[:, -1]) == np.any(found[:, -1]) == touches


@EACH
def test_the_quaternion_is_that_of_the_tip_plate_in_contact(model):
    model = model()
    point = in_contact(model)
    report, loads = model.report(point), model.answers(point).wrenches.reshape(-1, 6)
    w, *v = report.orientation
    assert np.linalg.norm(report.orientation) == pytest.approx(1.0, abs=1e-14) and w >= 0
    turned = rotation_vectors.matrices(np.array(v) / w)
    assert turned == pytest.approx(model.rod.place(point[:-1], loads).rotations[-1], abs=SOLVED)


@pytest.mark.parametrize("turn", [0.0, 1e-9, 1.5, 3.1, 3.2, 4.5, 6.0])
def test_the_quaternion_has_a_scalar_part_of_no_sign_at_any_turn(turn):
    bundled = TouchedSegment.load()
    rod = in_series(bundled.rod, 8)
    model = TouchedSegment(rod=rod, obstacle=bundled.obstacle)
    tension = turn / 6.0 * 9.0
    point = np.array([0.0, tension, np.inf])
    orientation, turned = model.evaluate(point).orientation, rod.place(point[:-1]).rotations[-1]
    w, x, y, z = orientation
    assert w >= 0 and np.linalg.norm(orientation) == pytest.approx(1.0, abs=1e-14)
    first_column = [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)]
    assert first_column == pytest.approx(turned[:, 0], abs=1e-12)


def marched_shortenings(model: TouchedSegment, tensions: np.ndarray, wrenches: np.ndarray) -> np.ndarray:
    """The sums over elements, marched in Python from tip to clamp."""
    rod, plates = model.rod, model.rod.place(tensions, wrenches)
    found, beyond, ahead = np.zeros(len(rod.names)), np.zeros(6), rod.half_lengths[0]
    for k in reversed(range(len(rod.segments))):
        segment = rod.segments[k]
        pulled = np.array([tensions[rod.names.index(name)] for name in segment.names])
        marched = march(segment.elements, pulled[None], (wrenches[k] + beyond)[None])
        for name, which in zip(segment.names, segment.trained, strict=True):
            found[rod.names.index(name)] += marched.shortenings[0, which]
        beyond = marched.base[0].copy()
        beyond[3:] += np.cross([ahead, 0.0, 0.0], beyond[:3])
    assert plates.inside
    return found


@EACH
def test_shortenings_are_sums_of_the_elements(model):
    model = model()
    wrenches = np.tile([0.1, -0.2, 0.15, 2e-4, -3e-4, 2e-4], (len(model.rod.segments), 1))
    tensions = np.array([12.0, 7.0])
    expected = marched_shortenings(model, tensions, wrenches)
    assert model.rod.shortening(tensions, wrenches) == pytest.approx(expected, abs=1e-12)
    point = in_contact(model)
    loads = model.answers(point).wrenches.reshape(-1, 6)
    expected = marched_shortenings(model, point[:-1], loads)
    assert model.report(point).shortenings == pytest.approx(expected, abs=SOLVED)


@EACH
def test_shortenings_change_with_tensions_and_wrenches_as_differences_do(model):
    rod = model().rod
    n = len(rod.segments)
    inputs = np.concatenate([[12.0, 7.0], np.tile([0.1, -0.2, 0.15, 2e-4, -3e-4, 2e-4], n)])
    steps = np.concatenate([[1e-3] * 2, np.tile([1e-4] * 3 + [1e-6] * 3, n)])
    _, found = reports.shortenings(rod.struct, inputs[:2], inputs[2:].reshape(n, 6))
    for k, step in enumerate(steps):
        ahead, behind = (inputs + sign * step * np.eye(len(inputs))[k] for sign in (1, -1))
        one, other = (rod.shortening(each[:2], each[2:].reshape(n, 6)) for each in (ahead, behind))
        expected = (one - other) / (2 * step)
        assert found[:, k] == pytest.approx(expected, abs=1e-5 * np.abs(expected).max() + 1e-12)


def test_the_shortening_of_a_tendon_is_the_work_that_its_tension_does():
    """Without contact the shortenings derive from a potential: their derivatives by tensions are symmetric."""
    slopes = TouchedSegment.load().report([15.0, 8.0, np.inf]).shortening_jacobian[:, :2]
    assert slopes[0, 1] == pytest.approx(slopes[1, 0], abs=2e-3 * slopes.max())


def test_a_finger_of_another_size_and_modulus_reports_the_same_turns_and_scaled_shortenings():
    bundled = TouchedSegment.load()
    size, modulus = 2.0, 0.5
    rod = scaled(bundled.rod, size, modulus)
    other = TouchedSegment(rod=rod, obstacle=facing_plane(rod.scene["geometry"]["side"], (0.0, 1.0)))
    point = in_contact(bundled)
    units = np.array([modulus * size**2] * 2 + [size])
    one, scaled_up = bundled.report(point), other.report(point * units)
    assert scaled_up.orientation == pytest.approx(one.orientation, abs=1e-9)
    assert scaled_up.shortenings == pytest.approx(size * one.shortenings, abs=1e-11)
    assert scaled_up.shortening_jacobian * units == pytest.approx(size * one.shortening_jacobian, rel=1e-6)
    assert scaled_up.orientation_error == pytest.approx(one.orientation_error)
    assert scaled_up.shortening_error == pytest.approx(size * one.shortening_error)


def test_reports_at_clamped_tensions_do_not_change_with_these_and_many_are_as_one():
    model = TouchedSegment.load()
    beyond = np.array([1e3, 5.0, np.inf])
    report = model.report(beyond)
    assert (
        not report.inside and not report.orientation_jacobian[:, 0].any() and not report.shortening_jacobian[:, 0].any()
    )
    points = np.array([beyond, in_contact(model)])
    many = model.report(points)
    for k, point in enumerate(points):
        for name in many._fields:
            assert getattr(many, name)[k] == pytest.approx(getattr(model.report(point), name))


def test_where_there_is_no_equilibrium_errors_are_infinite():
    model = two_segments()
    random, (lower, upper) = np.random.default_rng(3), model.limits
    points = lower + (upper - lower) * (1.2 * random.random((200, 3)) - 0.1)
    answer = model.evaluate(points)
    lost = ~np.isfinite(answer.error["tip"])
    assert lost.any() and np.array_equal(lost, ~np.isfinite(answer.orientation_error))
    assert np.array_equal(lost, ~np.isfinite(answer.shortening_error))
    assert np.array_equal(model.report(points).inside, answer.inside)


def test_eight_tendons_at_two_places_are_shorter_as_the_two_that_pull_as_much():
    bundled = TouchedSegment.load()
    tendons = [
        one | {"name": f"{one['name']}{k}", "tension": [0.0, 25.0]}
        for one in bundled.scene["tendons"]
        for k in range(4)
    ]
    rod = bundled.rod.assembled(bundled.scene | {"tendons": tendons})
    many = TouchedSegment(rod=rod, obstacle=bundled.obstacle)
    point = in_contact(bundled)
    several = np.append(np.repeat(point[:-1] / 4, 4), point[-1])
    one, other = bundled.report(point), many.report(several)
    assert many.evaluate(several).contact_force > 0.01
    assert other.orientation == pytest.approx(one.orientation, abs=1e-9)
    assert other.shortenings == pytest.approx(np.repeat(one.shortenings, 4), abs=1e-11)
    slopes = np.repeat(one.shortening_jacobian, [4, 4], axis=0)
    assert other.shortening_jacobian == pytest.approx(np.repeat(slopes, [4, 4, 1], axis=1), abs=1e-9)
