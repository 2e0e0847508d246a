"""The potential of tangential springs: its gradient, its tangent, its bound; and the return mapping."""

import numpy as np
import pytest

from fingerfem.mechanics.friction import springs

NORMAL = np.array([0.0, 0.6, 0.8])
NORMALS = np.tile(NORMAL, (4, 1))
K, BOUNDS = np.array([2e4, 5e4, 1e4, 3e4]), np.array([0.5, 2.0, 0.0, 1.0])


@pytest.fixture
def points():
    random = np.random.default_rng(3)
    return random.standard_normal((4, 3)) * 3e-5, random.standard_normal((4, 3)) * 3e-5


def test_forces_are_the_gradient_and_the_tangent_is_theirs(points):
    places, anchors = points
    found = springs(places, anchors, NORMALS, K, BOUNDS)
    assert found.slides.any() and not found.slides.all()
    for i in range(3):
        step = 1e-10 * np.eye(3)[i]
        ends = [springs(places + sign * step, anchors, NORMALS, K, BOUNDS) for sign in (1, -1)]
        slope = (ends[0].energy - ends[1].energy) / 2e-10
        np.testing.assert_allclose(slope, found.forces[:, i], atol=1e-5 * np.abs(found.forces).max())
        bent = (ends[0].forces - ends[1].forces) / 2e-10
        np.testing.assert_allclose(bent, found.stiffness[:, :, i], atol=1e-4 * np.abs(found.stiffness).max())


def test_forces_are_tangential_and_at_most_their_bounds(points):
    found = springs(*points, NORMALS, K, BOUNDS)
    np.testing.assert_allclose(found.forces @ NORMAL, 0.0, atol=1e-15)
    sizes = np.linalg.norm(found.forces, axis=1)
    assert (sizes <= BOUNDS * (1 + 1e-12)).all()
    np.testing.assert_allclose(sizes[found.slides], BOUNDS[found.slides])


def test_an_anchor_that_follows_leaves_the_spring_with_its_bound(points):
    places, anchors = points
    before = springs(places, anchors, NORMALS, K, BOUNDS)
    after = springs(places, anchors + before.slipped, NORMALS, K, BOUNDS)
    np.testing.assert_allclose(after.forces, before.forces, atol=1e-12)
    np.testing.assert_allclose(after.slipped, 0.0, atol=1e-15)


@pytest.mark.parametrize("slope", [0.9, 1.1])
def test_a_block_on_a_slope_slides_beyond_the_friction_angle(slope):
    """The springs share its weight: what sticks bears it all; what slides bears mu N."""
    friction, weight = 0.4, 2.0
    angle = slope * np.arctan(friction)
    normal, down = np.array([0.0, -np.sin(angle), np.cos(angle)]), np.array([0.0, 0.0, -1.0])
    bounds = np.full(4, friction * weight * np.cos(angle) / 4)
    along = down - (down @ normal) * normal
    anchors = np.zeros((4, 3))
    for stretch in np.linspace(0.0, 1e-3, 200):  # it moves down until the springs bear it, or slide
        found = springs(stretch * np.tile(along, (4, 1)), anchors, np.tile(normal, (4, 1)), K, bounds)
        if -found.forces.sum(axis=0) @ along + weight * (along @ along) <= 0:
            break
    assert found.slides.all() == (slope > 1)
    held = np.linalg.norm(found.forces.sum(axis=0)) / (weight * np.sin(angle))
    assert held == pytest.approx(friction / np.tan(angle)) if slope > 1 else held >= 1
