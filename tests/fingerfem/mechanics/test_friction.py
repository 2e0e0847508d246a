"""Coulomb's law of a point: Newton's step of it, its bound; the return mapping; a block on a slope."""

import numpy as np
import pytest

from fingerfem.mechanics.friction import across, law, returned

NORMAL = np.array([0.0, 0.6, 0.8])
NORMALS = np.tile(NORMAL, (4, 1))
K, BOUNDS = np.array([2e4, 5e4, 1e4, 3e4]), np.array([0.5, 2.0, 0.0, 1.0])
SHARES = [1.0, 0.1, 1e-3]  # of k that r is


@pytest.fixture
def stretches():
    return np.random.default_rng(3).standard_normal((4, 3)) * 6e-5 @ across(NORMALS)[0]


def disobeyed(forces: np.ndarray, stretches: np.ndarray, bounds: np.ndarray, r: np.ndarray) -> np.ndarray:
    """The law as an equation, whose root the forces are, shape (m, 3) [N]."""
    way = forces + r[:, None] * (stretches - forces / K[:, None])
    size = np.linalg.norm(way, axis=1)[:, None]
    sliding = forces - bounds[:, None] * way / np.where(size > 0, size, 1.0)
    return np.where(size > bounds[:, None], sliding, r[:, None] * (forces / K[:, None] - stretches))


@pytest.mark.parametrize("share", SHARES)
def test_the_linearised_law_is_newtons_step(stretches, share):
    """By differences of the law: its root by f, and how that changes with s and b."""
    r, tried = share * K, np.random.default_rng(5).standard_normal((4, 3)) @ across(NORMALS)[0]
    step = law(stretches, NORMALS, (K, r), BOUNDS, tried)
    assert step.slides.any() and not step.slides.all()
    base = np.linalg.svd(across(NORMALS)[:1])[0][0, :, :2]  # of the tangential plane

    def slope(by: int, change: float) -> np.ndarray:
        """Differences of the law by f, s or b, shape (m, 3, 2), or (m, 3, 1)."""
        columns = []
        for way in base.T if by < 2 else [1.0]:
            ends = []
            for sign in (-1, 1):
                given = [tried, stretches, BOUNDS]
                given[by] = given[by] + sign * change * way
                ends.append(disobeyed(*given, r))
            columns.append((ends[1] - ends[0]) / (2 * change))
        return np.stack(columns, axis=2)

    by_force = slope(0, 1e-6)
    close = {"atol": 1e-6 * np.abs(tried).max()}
    newton = disobeyed(tried, stretches, BOUNDS, r) + np.einsum("mia,ja,mj->mi", by_force, base, step.forces - tried)
    np.testing.assert_allclose(newton, 0.0, **close)
    turned = np.einsum("mia,ja,mjb->mib", by_force, base, step.stiffness @ base) + slope(1, 1e-10)
    np.testing.assert_allclose(turned / K[:, None, None], 0.0, atol=1e-5)
    grown = np.einsum("mia,ja,mj->mi", by_force, base, step.by_bounds) + slope(2, 1e-8)[:, :, 0]
    np.testing.assert_allclose(grown, 0.0, atol=1e-5)


@pytest.mark.parametrize("share", SHARES)
def test_its_root_is_the_return_mapping_for_any_stiffness_r(stretches, share):
    lawful = returned(stretches, K, BOUNDS)
    np.testing.assert_allclose(disobeyed(lawful, stretches, BOUNDS, share * K), 0.0, atol=1e-12)
    np.testing.assert_allclose(law(stretches, NORMALS, (K, share * K), BOUNDS, lawful).forces, lawful, atol=1e-12)
    tried = np.zeros((4, 3))
    for _ in range(10):
        tried = law(stretches, NORMALS, (K, share * K), BOUNDS, tried).forces
    np.testing.assert_allclose(tried, lawful, atol=1e-12)


def test_forces_are_tangential_and_at_most_their_bounds(stretches):
    forces = returned(stretches, K, BOUNDS)
    np.testing.assert_allclose(forces @ NORMAL, 0.0, atol=1e-15)
    sizes, slides = np.linalg.norm(forces, axis=1), K * np.linalg.norm(stretches, axis=1) > BOUNDS
    assert (sizes <= BOUNDS * (1 + 1e-12)).all() and slides.any() and not slides.all()
    np.testing.assert_allclose(sizes[slides], BOUNDS[slides])
    np.testing.assert_allclose(forces[~slides], (K[:, None] * stretches)[~slides])
    np.testing.assert_allclose(returned(forces / K[:, None], K, BOUNDS), forces, atol=1e-15)  # of a spring that is left


@pytest.mark.parametrize("slope", [0.9, 1.1])
def test_a_block_on_a_slope_slides_beyond_the_friction_angle(slope):
    """The springs share its weight: what sticks supports it all; what slides supports mu N."""
    friction, weight = 0.4, 2.0
    angle = slope * np.arctan(friction)
    normal, down = np.array([0.0, -np.sin(angle), np.cos(angle)]), np.array([0.0, 0.0, -1.0])
    bounds = np.full(4, friction * weight * np.cos(angle) / 4)
    along = down - (down @ normal) * normal
    for stretch in np.linspace(0.0, 1e-3, 200):  # it moves down until the springs bear it, or slide
        stretched = stretch * np.tile(along, (4, 1))
        forces = returned(stretched, K, bounds)
        if -forces.sum(axis=0) @ along + weight * (along @ along) <= 0:
            break
    slides = law(stretched, np.tile(normal, (4, 1)), (K, K), bounds, forces).slides
    assert slides.all() == (slope > 1)
    held = np.linalg.norm(forces.sum(axis=0)) / (weight * np.sin(angle))
    assert held == pytest.approx(friction / np.tan(angle)) if slope > 1 else held >= 1
