"""A base of any orientation: the same motion, seen from the base, where gravity and objects turn with it."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

mujoco = pytest.importorskip("mujoco")

from control.mujoco import Simulation, attach  # noqa: E402

GRAVITY = 3.0, -5.0, -8.0  # in the base's axes [m/s^2]
SCENE = """
<mujoco>
  <option timestep="0.001" tolerance="{tolerance}" gravity="{gravity}"/>
  <worldbody><body name="palm"/><geom {geom} pos="{pos}" quat="{quat}" friction="0.5 0 0"/></worldbody>
</mujoco>
"""
OBJECTS = {
    "ball": ('type="sphere" size="0.015"', (0.046, 0.028, 0.001)),
    "box": ('type="box" size="0.02 0.01 0.02"', (0.046, 0.023, 0.001)),
    "nothing near": ('type="sphere" size="0.001"', (0.0, 0.5, 0.0)),
}


def pressed(rod, base: Rotation, shape: str, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Positions of the sections in the base's axes, shape (5, 3) [m], and the contact force [N], after 0.6 s."""
    geom, at = OBJECTS[shape]
    quaternion = base.as_quat(scalar_first=True)
    given = {"gravity": base.apply(GRAVITY), "pos": base.apply(at), "quat": quaternion}
    text = {name: " ".join(map(repr, one.tolist())) for name, one in given.items()}
    spec = mujoco.MjSpec.from_string(SCENE.format(tolerance=tolerance, geom=geom, **text))
    finger = attach(spec, rod, "palm", quaternion=quaternion)
    simulation = Simulation(spec.compile(), [finger])
    simulation.pull(0, [35.0, 4.0])
    simulation.advance(0.6)
    centres = np.array([simulation.data.body(name).xpos for name in finger.sections])
    return base.inv().apply(centres), simulation.contact_forces()


@pytest.mark.parametrize("shape", OBJECTS)
def test_a_base_of_any_orientation_gives_the_same_positions_and_force(rod, shape):
    first, force = pressed(rod, Rotation.identity(), shape, 1e-13)
    assert (force[0] > 1) == (shape != "nothing near")
    for base in Rotation.random(3, random_state=np.random.default_rng(3)):
        found, other = pressed(rod, base, shape, 1e-13)
        assert found == pytest.approx(first, abs=1e-9 * np.abs(first).max())
        assert other == pytest.approx(force, rel=1e-9)


def test_with_the_default_tolerance_of_the_solver_the_force_differs_by_that(rod):
    base = Rotation.random(random_state=np.random.default_rng(4))
    (first, force), (found, other) = (pressed(rod, one, "ball", 1e-8) for one in (Rotation.identity(), base))
    assert found == pytest.approx(first, abs=1e-8 * np.abs(first).max()) and other == pytest.approx(force, rel=1e-6)
