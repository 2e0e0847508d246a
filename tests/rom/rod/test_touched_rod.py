"""A finger that an object touches: identities of its potential, rigid plates, and exchanged axes."""

import numpy as np
import pytest

from rom import Plane, TouchedSegment

PAIRS = [(60.0, 20.0), (20.0, 0.0), (80.0, 50.0)]
DEEP = 0.003  # of the plane beyond touch [m]


def pressed(model, tensions) -> np.ndarray:
    return np.array([*tensions, float(model.outputs([[*tensions, 0.05]])[0, 4]) - DEEP])


@pytest.mark.parametrize("tensions", PAIRS)
def test_a_tension_changes_the_contact_force_as_the_distance_changes_the_shortening(model, tensions):
    """Maxwell's relation: both are second derivatives of one potential."""
    point = pressed(model, tensions)
    by_tensions = model.jacobian(point)[3, :2]
    by_distance = model.report(point).shortening_jacobian[:, 2]
    assert by_tensions == pytest.approx(by_distance, abs=2e-3 * np.abs(by_tensions).max())
    assert np.abs(by_tensions).min() > 5e-3  # N/N


def test_the_tip_plate_moves_as_a_rigid_body_and_its_centre_is_the_tip(model):
    point, half = pressed(model, PAIRS[0]), model.rod.half_lengths
    rest = model.rod.rest + np.array([[0, 0, 0], [1, 1, 1], [1, -1, 1], [-0.9, 1, -1], [-0.9, -1, 1]]) * half
    moved = rest + model.displacement(point, rest)
    between = [np.linalg.norm(one[:, None] - one, axis=2) for one in (rest, moved)]
    assert between[1] == pytest.approx(between[0], abs=1e-9)
    answer = model.evaluate(point)
    assert moved[0] - rest[0] == pytest.approx(answer.tip, abs=1e-8) and answer.contact_force > 1
    assert answer.shortenings == pytest.approx(model.shortening(point), abs=1e-8)
    w, *vector = answer.orientation
    turned = rest[1] - rest[0] + 2 * np.cross(vector, np.cross(vector, rest[1] - rest[0]) + w * (rest[1] - rest[0]))
    assert moved[1] - moved[0] == pytest.approx(turned, abs=1e-8)


def test_exchanged_axes_exchange_the_tendons_and_the_tip_s_coordinates(model):
    """The bundled finger is its own image in the plane y = z: one tendon is on y, the other on z."""
    half = model.rod.half_lengths[1]
    beside = Plane(centre=(0, 0, half), direction=(0, 0, 1), normal=(0, 0, -1), distances=(0.0, 0.05))
    other = TouchedSegment(rod=model.rod, obstacle=beside)
    for tensions in PAIRS:
        point = pressed(model, tensions)
        one, image = model.evaluate(point), other.evaluate([*tensions[::-1], point[-1]])
        assert one.contact_force == pytest.approx(image.contact_force, rel=1e-6)
        assert one.tip == pytest.approx(image.tip[[0, 2, 1]], abs=1e-9)
        assert one.shortenings == pytest.approx(image.shortenings[::-1], abs=1e-9)
