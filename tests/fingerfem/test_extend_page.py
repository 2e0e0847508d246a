"""The examples of docs/howto/extend.md run, and are what they say."""

import re
from pathlib import Path

import numpy as np
import pytest
import ufl

from fingerfem.mechanics import obstacles, strain_energy
from fingerfem.scene import obstacle as scene_obstacle
from fingerfem.scene.laws import REGISTERED

DOCS = Path(__file__).resolve().parents[2] / "docs"
ALONG, SIDE = (0.1, 0.2, 1.0), 0.010


@pytest.fixture(scope="module")
def page():
    """Names that the page's code defines."""
    names: dict = {"__name__": "__main__"}
    for code in re.findall(r"```python\n(.*?)```", (DOCS / "howto" / "extend.md").read_text(), re.DOTALL):
        exec(compile(code, "docs/howto/extend.md", "exec"), names)
    yield names
    REGISTERED.pop("gent")
    scene_obstacle.NEEDS.pop("capsule")
    scene_obstacle.MAY_HAVE.pop("capsule")


@pytest.mark.long
def test_a_finger_of_gent_s_rubber_is_nearly_neo_hookean_with_long_chains(page):
    draft = page["load_scene"]("scenes/draft.toml")
    long = page["Gent"](C1=1.9e6, Jm=1e5, D1=2.43e-7)
    scenes = draft, draft.model_copy(update={"material": long})
    forces = [page["FingerModel"](one).solve([50.0, 0.0], 0.005, sensitivities=False).contact_force for one in scenes]
    assert forces[1] == pytest.approx(forces[0], rel=1e-5)
    assert page["state"].contact_force < 0.99 * forces[0]


@pytest.mark.long
def test_the_tip_of_the_cone_presses_by_its_rounding_from_its_corner(page):
    (contact,) = page["touched"].contact_forces([12.0, 3.0, 0.0])
    assert page["answer"].inside
    assert contact.place == pytest.approx(page["cone"].centre + page["cone"].rounding * contact.normal, abs=1e-9)
    assert -contact.force[1] == pytest.approx(page["answer"].contact_force, rel=1e-9)


def test_gent_s_law_is_its_closed_form_in_shear(page):
    law, shear = page["Gent"](C1=1.9e6, Jm=2.0, D1=2.43e-7), 0.3
    F = np.eye(3)
    F[0, 1] = shear
    C = ufl.as_matrix((F.T @ F).tolist())
    assert strain_energy.energy(law)(C)(()) == pytest.approx(-1.9e6 * 2.0 * np.log(1 - shear**2 / 2.0), rel=1e-12)


@pytest.mark.parametrize(("shape", "half"), [("sphere", 1e-15), ("cylinder", 0.1)])
def test_a_capsule_s_ends_are_a_sphere_and_its_side_is_a_cylinder(page, shape, half):
    placed = page["placed"] | {"direction": [0.1, 1.0, 0.2], "axis": list(ALONG)}
    capsule = obstacles.body(page["CapsuleObstacle"](half=half, **placed), SIDE)
    if shape == "sphere":
        placed.pop("axis")
    other = obstacles.body(scene_obstacle.Obstacle(shape=shape, **placed), SIDE)
    points = np.array([0.045, 0.005, 0.0]) + 0.006 * np.random.default_rng(5).uniform(-1, 1, (200, 3))
    d = np.full(len(points), 0.002)
    both = [
        (
            body.signed_distance(points.T, d, obstacles.NUMPY),
            body.normal_at(points, d),
            body.curvature_at(points, d),
            body.touch_distance(points),
        )
        for body in (capsule, other)
    ]
    for own, expected in zip(*both, strict=True):
        assert own == pytest.approx(expected, rel=1e-9, abs=1e-10)


def test_a_capsule_s_curvature_is_its_normals_gradient(page):
    capsule = obstacles.body(page["CapsuleObstacle"](half=0.003, **page["placed"] | {"axis": list(ALONG)}), SIDE)
    points = np.array([0.045, 0.005, 0.0]) + 0.006 * np.random.default_rng(6).uniform(-1, 1, (50, 3))
    d, step = np.zeros(len(points)), 1e-7
    for k, ahead in enumerate(step * np.eye(3)):
        ends = [capsule.normal_at(points + sign * ahead, d) for sign in (1, -1)]
        slope = (ends[0] - ends[1]) / (2 * step)
        assert slope == pytest.approx(capsule.curvature_at(points, d)[:, :, k], rel=1e-5, abs=1e-4)


def test_motors_that_pull_lengths_in_reach_the_tensions_that_need_them(page):
    motors = page["motors"]
    for tensions in np.random.default_rng(7).uniform(0.0, 60.0, (5, 2)):
        assert motors.tensions(motors.lengths(tensions)) == pytest.approx(tensions, abs=1e-9)
    slack = motors.tensions(np.array([0.002, -0.001]))  # [m]
    assert slack[1] == 0.0 and slack[0] == pytest.approx(10.5, abs=0.5)
    assert motors.lengths(slack)[0] == pytest.approx(0.002, abs=1e-12) and motors.lengths(slack)[1] > -0.001


def test_a_finger_before_the_end_of_a_capsule_is_one_before_a_sphere(page):
    placed = {"centre": [0.045, 0.020, 0.0], "radius": 0.008, "distance": [-0.01, 0.02]}  # [m]
    ball = scene_obstacle.Obstacle(shape="sphere", **placed)
    scene = page["load_scene"]("scenes/draft.toml").model_copy(update={"obstacle": ball})
    state = page["FingerModel"](scene).solve([30.0, 0.0], distance=0.003, sensitivities=False)
    assert page["state"].contact_force == pytest.approx(state.contact_force, rel=1e-6)
