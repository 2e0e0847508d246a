"""Points with friction: they press as the compiled forms do, and their tangent is the derivative of their forces."""

import numpy as np
import pytest

from fingerfem import FingerModel
from fingerfem.friction_history import friction_points
from fingerfem.scene.scene import Scene

ROUND = {"centre": [0.03, 0.016, 0.0], "direction": [-0.6, 0.8, 0.0], "distance": [-0.006, 0.03], "method": "penalty"}
SHAPES = {
    "plane": {"distance": [0.001, 0.031], "method": "penalty"},
    "sphere": {"shape": "sphere", "radius": 0.008} | ROUND,
    "box": {"shape": "box", "sides": [0.014, 0.014, 0.014], "rotation": [0.0, 0.0, 0.3], "rounding": 0.002} | ROUND,
}


def pressed(table: dict, shape: str):
    """The problem of a finger that presses on a shape without friction, and its points with friction of 0.4."""
    model = FingerModel(Scene.model_validate(table | {"obstacle": SHAPES[shape]}))
    tensions = [40.0, 5.0] if shape == "plane" else [10.0, 0.0]
    touch = model.solve(tensions, None, sensitivities=False).touch_distance
    model.solve(tensions, touch - (0.007 if shape == "plane" else 0.001), sensitivities=False)
    return model.problem, friction_points(model.problem, 0.4)


def nodal(points, shape: tuple) -> np.ndarray:
    """The forces that obey the laws, by nodes, shape (nodes, 3) [N]."""
    drag = points.drag()
    forces, at_nodes = drag.lawful() - drag.pushing()[0], np.zeros(shape)
    np.add.at(at_nodes, drag.points.nodes, drag.points.weights[:, :, None] * forces[:, None])
    return at_nodes


@pytest.mark.long
@pytest.mark.parametrize("shape", SHAPES)
def test_points_press_as_the_compiled_forms_do(table, shape):
    problem, points = pressed(table, shape)
    forms = problem.contact.nodal_force()
    np.testing.assert_allclose(nodal(points, forms.shape), forms, atol=1e-9 * np.abs(forms).max())
    assert points.drag().normal_forces.sum() > 0.1 and points.unlawful() == 0.0


@pytest.mark.parametrize("shape", ["plane", "sphere", pytest.param("box", marks=pytest.mark.long)])
def test_the_tangent_is_the_derivative_of_the_forces(table, shape):
    """Some points stick, and some slide; on a ball the normals turn as well."""
    problem, points = pressed(table, shape)
    u = problem.fields.u.x.array
    random = np.random.default_rng(2)
    drag = points.drag()
    slid = 3 * random.standard_normal(3) * np.median(drag.bounds / drag.points.stiffness)
    at = np.unique(drag.points.nodes)
    points.begin(slid)
    u.reshape(-1, 3)[at] += random.standard_normal((len(at), 3)) * np.linalg.norm(slid) / 5
    for _ in range(10):
        points.unlawful()
    slides = points.drag().tangential.slides
    assert points.unlawful() == pytest.approx(0.0, abs=1e-12) and slides.any()
    springs, taken = points.springs(), points.unsymmetric()
    here = u.copy()
    for _ in range(3):
        along = np.zeros_like(u).reshape(-1, 3)
        along[at] = random.standard_normal((len(at), 3))
        ends = []
        for sign in (-1, 1):
            u[:] = here + sign * 1e-12 * along.ravel()
            ends.append(nodal(points, along.shape))
        u[:] = here
        difference, change = (ends[1] - ends[0]) / 2e-12, np.zeros_like(along)
        moved = np.einsum("mij,mj->mi", springs.stiffness, along[springs.nodes].reshape(len(springs.nodes), -1))
        np.add.at(change, springs.nodes, moved.reshape(*springs.nodes.shape, 3))
        change -= (taken.left.T @ (taken.right @ along.ravel())).reshape(-1, 3)
        assert np.abs(difference - change).max() < 1e-3 * np.abs(change).max()
