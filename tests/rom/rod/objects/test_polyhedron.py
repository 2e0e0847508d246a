"""Hulls as contact asks for them: Euler's formula, planes, orientations and volumes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from rom.rod.objects.polyhedron import MOST_CORNERS, polyhedron

CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
SEEDS = st.integers(0, 10_000)


def volume(hull: dict) -> float:
    """By the divergence theorem, of triangles seen counterclockwise from outside."""
    one, two, three = hull["vertices"][hull["triangle_corners"]].swapaxes(0, 1)
    return float(np.einsum("ti,ti->", one, np.cross(two, three)) / 6)


@given(SEEDS)
def test_a_turned_box_has_six_faces_twelve_edges_and_its_volume(seed):
    random = np.random.default_rng(seed)
    half, turn = random.uniform(0.2, 2.0, 3), Rotation.from_rotvec(random.standard_normal(3))
    inner = random.uniform(-0.9, 0.9, (10, 3))  # within it, and so no corners
    hull = polyhedron(turn.apply(np.concatenate([CUBE, inner]) * half))
    assert [hull[name] for name in ("corners", "edges", "faces", "triangles")] == [8, 12, 6, 12]
    assert np.sort(hull["lengths"]) == pytest.approx(np.repeat(np.sort(2 * half), 4))
    assert np.sort(hull["heights"]) == pytest.approx(np.repeat(np.sort(half), 2))
    assert volume(hull) == pytest.approx(8 * half.prod())


@given(SEEDS, st.integers(4, 40))
def test_edges_lie_on_both_their_faces_and_bend_outwards(seed, count):
    points = np.random.default_rng(seed).standard_normal((count, 3)) * 0.01
    hull = polyhedron(points)
    assert hull["corners"] - hull["edges"] + hull["faces"] == 2
    assert hull["triangles"] == 2 * hull["corners"] - 4
    above = points @ hull["normals"].T - hull["heights"]
    assert above.max() < 1e-12 and np.linalg.norm(hull["normals"], axis=1) == pytest.approx(np.ones(hull["faces"]))
    for side in hull["sides"].T:
        for end in hull["ends"].T:
            on = np.einsum("ei,ei->e", hull["vertices"][end], hull["normals"][side]) - hull["heights"][side]
            assert np.abs(on).max() < 1e-9
    first, second = hull["normals"][hull["sides"]].swapaxes(0, 1)
    assert (np.einsum("ei,ei->e", hull["along"], np.cross(first, second)) > 0).all()


@given(SEEDS)
def test_its_volume_is_that_of_scipy_and_triangles_belong_to_their_faces(seed):
    points = np.random.default_rng(seed).standard_normal((25, 3))
    hull = polyhedron(points)
    assert volume(hull) == pytest.approx(ConvexHull(points).volume)
    one, two, three = hull["vertices"][hull["triangle_corners"]].swapaxes(0, 1)
    normals = np.cross(two - one, three - one)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    assert normals == pytest.approx(hull["normals"][hull["triangle_faces"]], abs=1e-6)


def test_a_hull_of_too_many_corners_or_none_is_refused():
    ball = np.random.default_rng(0).standard_normal((MOST_CORNERS + 1, 3))
    ball /= np.linalg.norm(ball, axis=1)[:, None]
    assert polyhedron(ball[1:])["corners"] == MOST_CORNERS
    with pytest.raises(ValueError, match=f"a hull of at most {MOST_CORNERS} corners, got {MOST_CORNERS + 1}"):
        polyhedron(ball)
    with pytest.raises(ValueError, match="vertices must be at least four that are not in one plane, got 4"):
        polyhedron(CUBE[:4])
