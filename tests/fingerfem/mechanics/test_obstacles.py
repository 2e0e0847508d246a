"""Signed distances of obstacles: their normals are their gradients, and they touch where they say."""

import numpy as np
import pytest
from pydantic import ValidationError

from fingerfem.mechanics.obstacles import NUMPY, body
from fingerfem.scene.obstacle import Obstacle

TOP = 0.005  # largest y of the section [m]
USUAL = {"distance": [0.001, 0.031], "method": "penalty"}
SHAPES = {
    "facing plane": {},
    "tilted plane": {"centre": [0.05, 0.02, 0.0], "normal": [0.3, -1.0, 0.4]},
    "sphere": {"shape": "sphere", "centre": [0.05, 0.02, 0.003], "radius": 0.012, "direction": [0.2, 1.0, -0.1]},
    "cylinder": {"shape": "cylinder", "centre": [0.05, 0.02, 0.0], "axis": [0.3, 0.1, 1.0], "radius": 0.008},
    "box": {
        "shape": "box",
        "centre": [0.05, 0.02, 0.0],
        "sides": [0.02, 0.01, 0.03],
        "rotation": [0.2, -0.4, 0.6],
        "rounding": 0.002,
    },
}


@pytest.fixture(params=SHAPES)
def obstacle(request):
    return body(Obstacle(**SHAPES[request.param] | USUAL), TOP)


@pytest.fixture
def points():
    return np.random.default_rng(0).uniform([0, -0.02, -0.02], [0.08, 0.02, 0.02], (400, 3))


def test_normals_are_gradients_of_the_distance_and_unit_vectors(obstacle, points):
    d, h = np.random.default_rng(1).uniform(0, 0.02, len(points)), 1e-7
    outside = obstacle.signed_distance(points.T, d, NUMPY) > 1e-5
    points, d = points[outside], d[outside]
    normals = obstacle.normal_at(points, d)

    def distance(places: np.ndarray) -> np.ndarray:
        return obstacle.signed_distance(places.T, d, NUMPY)

    steps = [(distance(points + step) - distance(points - step)) / (2 * h) for step in h * np.eye(3)]
    assert len(points) > 100
    assert np.abs(np.column_stack(steps) - normals).max() < 1e-6
    assert np.abs(np.linalg.norm(normals, axis=1) - 1).max() < 1e-12
    turned = [
        (obstacle.normal_at(points + step, d) - obstacle.normal_at(points - step, d)) / 2 for step in h * np.eye(3)
    ]
    off = np.abs(np.stack(turned, axis=2) / h - obstacle.curvature_at(points, d)).max(axis=(1, 2))
    assert np.quantile(off, 0.98) < 1e-3  # [1/m]; a box's changes at once where its edges begin


def test_at_the_touch_distance_a_point_is_touched_and_before_it_is_not(obstacle, points):
    found = obstacle.touch_distance(points)
    touching = np.isfinite(found)
    at = obstacle.signed_distance(points[touching].T, found[touching], NUMPY)
    assert touching.sum() > 20 and np.abs(at).max() < 1e-11
    for further in (1e-6, 1e-4, 1e-2, 1.0):  # [m]
        assert obstacle.signed_distance(points[touching].T, found[touching] + further, NUMPY).min() > 0
    for d in np.linspace(-0.05, 0.1, 60):
        assert np.all(obstacle.signed_distance(points[~touching].T, d, NUMPY) > 0)


@pytest.mark.parametrize("scale", [1e-200, 1e-6, 1e6, 1e200])
@pytest.mark.parametrize("shape", SHAPES)
def test_normals_axes_and_directions_may_have_any_length(shape, scale, points):
    table = {"direction": [0.2, 1.0, -0.1]} | SHAPES[shape] | USUAL
    scaled = {name: [scale * part for part in table[name]] for name in ("direction", "normal", "axis") if name in table}
    ours, theirs = (body(Obstacle(**one), TOP) for one in (table | scaled, table))
    for name in ("direction", "normal", "axis"):
        assert getattr(ours, name, ()) == pytest.approx(getattr(theirs, name, ()), rel=1e-15)
    d = np.full(len(points), 0.003)
    assert ours.signed_distance(points.T, 0.003, NUMPY) == pytest.approx(
        theirs.signed_distance(points.T, 0.003, NUMPY), abs=1e-16
    )
    assert ours.normal_at(points, d) == pytest.approx(theirs.normal_at(points, d), abs=1e-13)
    with np.errstate(invalid="ignore"):
        assert ours.touch_distance(points) == pytest.approx(theirs.touch_distance(points), abs=1e-11)


def test_the_facing_plane_is_what_scenes_had_before_there_were_shapes(points):
    plane = body(Obstacle(**USUAL), TOP)
    assert np.array_equal(plane.touch_distance(points), points[:, 1] - TOP)
    assert np.array_equal(plane.signed_distance(points.T, 0.01, NUMPY), -(points[:, 1] - TOP - 0.01))


@pytest.mark.parametrize(
    ("table", "rule"),
    [
        ({"shape": "sphere", "centre": [0, 0.02, 0]}, "radius must be given for a sphere"),
        ({"shape": "sphere", "centre": [0, 0.02, 0], "radius": 0.01, "axis": [0, 0, 1]}, "axis must be left out of a"),
        ({"normal": [0, -1, 0.1]}, "centre must be given for a plane with a normal"),
        ({"centre": [0, 0.02, 0], "normal": [0, -1, 0], "direction": [0, -1, 0]}, "direction must lead the plane away"),
        (
            {"shape": "cylinder", "centre": [0, 0.02, 0], "radius": 0.01, "axis": [0, 1, 0]},
            "direction must not be along the cylinder's axis",
        ),
        (
            {"shape": "box", "centre": [0, 0.02, 0], "sides": [0.01, 0.01, 0.01], "rounding": 0.006},
            "rounding must be at most half the shortest side",
        ),
        (
            {"shape": "sphere", "centre": [0, 0.02, 0], "radius": 0.01, "pad": {"name": "tip", "x": [0.04, 0.05]}},
            "pad must be left out unless",
        ),
        (
            {"shape": "sphere", "centre": [0, 0.02, 0], "radius": 0.01, "direction": [0, 0, 0]},
            "direction must be a vector of some length",
        ),
    ],
)
def test_an_obstacle_that_is_not_placed_is_refused(table, rule):
    with pytest.raises(ValidationError, match=rule):
        Obstacle(**table | USUAL)


def test_the_facing_plane_is_written_as_before_there_were_shapes():
    assert set(Obstacle(**USUAL).model_dump()) == {"distance", "method", "stiffness", "pad"}
    sphere = Obstacle(**SHAPES["sphere"] | USUAL)
    assert Obstacle(**sphere.model_dump()) == sphere
