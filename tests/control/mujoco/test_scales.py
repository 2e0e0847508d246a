"""The same finger in other units, orientations and numbers: the same answer at a step of a millisecond."""

from itertools import product

import numpy as np
import pytest
from assembled import in_series, scaled
from scipy.spatial.transform import Rotation

mujoco = pytest.importorskip("mujoco")

from control.mujoco import Simulation, attach  # noqa: E402

WALL = 0.010  # [m], from the finger
TENSIONS = np.array([30.0, 5.0])
SCENE = """
<mujoco>
  <option timestep="{step}" gravity="{gravity}" tolerance="1e-14" iterations="200"/>
  <worldbody>
    <body name="palm" pos="0.3 -0.2 0.1" quat="{quaternion}">
      <geom name="wall" type="plane" pos="0 {wall} 0" zaxis="0 -1 0" size="1 1 1" friction="{friction} 0 0"/>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.fixture(scope="module")
def sagged(model):
    """Coordinates of the bundled finger's sections at rest under its weight, shape (n,)."""
    spec = scene(1.0, gravity=(0, 0, -9.81))
    finger = attach(spec, model.rod, "palm")
    simulation = Simulation(spec.compile(), [finger])
    simulation.pull(0, TENSIONS)
    simulation.advance(0.6)
    return simulation.data.qpos.copy()


def scene(wall, step=1e-3, gravity=(0, 0, 0), quaternion=(1, 0, 0, 0), friction=0.0):
    vectors = {"gravity": gravity, "quaternion": quaternion}
    written = {name: " ".join(repr(float(one)) for one in vector) for name, vector in vectors.items()}
    return mujoco.MjSpec.from_string(SCENE.format(step=step, wall=wall, friction=friction, **written))


@pytest.mark.parametrize(("modulus", "mass"), [*product([1e-3, 1.0, 1e3], repeat=2), (10.0, 0.1), (0.1, 10.0)])
@pytest.mark.parametrize("touches", [False, True])
def test_modulus_and_mass_do_not_matter_over_six_decades(model, sagged, modulus, mass, touches):
    rod, slow = scaled(model.rod, modulus=modulus), np.sqrt(mass / modulus)
    gravity = -9.81 * modulus / mass * (not touches)
    spec = scene(0.005 + WALL if touches else 1.0, step=1e-3 * max(slow / 3, 1.0), gravity=(0, 0, gravity))
    finger = attach(spec, rod, "palm", density=1100.0 * mass, relaxation=0.005 * slow)
    simulation = Simulation(spec.compile(), [finger], rate=500.0 * modulus / max(slow, 1.0))
    simulation.pull(0, TENSIONS * modulus)
    simulation.advance(0.6 * max(slow, 1.0))
    assert not simulation.left.any() and not simulation.lost.any()
    if touches:
        expected = float(model.evaluate([*TENSIONS, WALL]).contact_force)
        assert simulation.contact_forces()[0] / modulus == pytest.approx(expected, rel=0.002)
    else:
        np.testing.assert_allclose(simulation.data.qpos, sagged, atol=1e-7)


@pytest.mark.parametrize("length", [0.1, 10.0])
def test_a_finger_of_5_mm_and_one_of_half_a_metre_press_alike(model, length):
    rod = scaled(model.rod, length=length)
    spec = scene((0.005 + WALL) * length)
    finger = attach(spec, rod, "palm", relaxation=0.005 * length)
    simulation = Simulation(spec.compile(), [finger], rate=500.0 * length**2 / max(length, 1.0))
    simulation.pull(0, TENSIONS * length**2)
    simulation.advance(0.6 * max(length, 1.0))
    expected = float(model.evaluate([*TENSIONS, WALL]).contact_force)
    assert simulation.contact_forces()[0] / length**2 == pytest.approx(expected, rel=0.005)


@pytest.mark.parametrize("count", [1, 8, pytest.param(24, marks=pytest.mark.long)])
def test_the_number_of_fingers_does_not_matter(model, count):
    spec, random = scene(1.0), np.random.default_rng(count)
    both = in_series(model.rod, 2)
    parts = [model.rod if k % 4 else both for k in range(count)]
    fingers = [
        attach(spec, part, "palm", position=(0.0, 0.0, 0.05 * k), name=f"finger {k}") for k, part in enumerate(parts)
    ]
    simulation = Simulation(spec.compile(), fingers)
    tensions = random.uniform(0.0, 8.0, (count, 2))
    for k, one in enumerate(tensions):
        simulation.pull(k, one)
    simulation.advance(1.5)
    for finger, one in zip(fingers, tensions, strict=True):
        clamp = simulation.data.body(finger.clamp)
        centres = [clamp.xmat.reshape(3, 3).T @ (simulation.data.body(one).xpos - clamp.xpos) for one in finger.plates]
        np.testing.assert_allclose(centres, finger.rod.place(one).centres, atol=1e-6)


def rested(rod, quaternion, wall, friction, count):
    """Coordinates, contact force and wrenches of a finger whose base and gravity are rotated."""
    turned = Rotation.from_quat(np.asarray(quaternion)[[1, 2, 3, 0]]).as_matrix()
    spec = scene(wall, gravity=turned @ [1.0, -5.0, 8.0], quaternion=quaternion, friction=friction)
    finger = attach(spec, in_series(rod, count), "palm", position=(0.01, 0.0, 0.02))
    simulation = Simulation(spec.compile(), [finger])
    simulation.pull(0, TENSIONS)
    simulation.advance(0.4)
    return simulation.data.qpos.copy(), simulation.contact_forces(), simulation.wrenches()[0]


@pytest.mark.parametrize(
    ("wall", "friction", "count"), [(1.0, 0.0, 1), (1.0, 0.0, 2), (0.005 + WALL, 0.0, 1), (0.005 + WALL, 0.6, 1)]
)
def test_the_orientation_of_the_base_does_not_matter(model, wall, friction, count):
    expected = rested(model.rod, (1, 0, 0, 0), wall, friction, count)
    assert (expected[1][0] > 1) == (wall < 1)
    quarter = [(np.sqrt(0.5), 0, 0, np.sqrt(0.5)), (0, 0, 1, 0)]
    for quaternion in [*quarter, *np.random.default_rng(0).normal(size=(4, 4))]:
        found = rested(model.rod, quaternion / np.linalg.norm(quaternion), wall, friction, count)
        for one, other in zip(found, expected, strict=True):
            np.testing.assert_allclose(one, other, rtol=0, atol=1e-9)  # forces are stiff: 1e-16 m are 1e-10 N
