"""Depths of MuJoCo's contacts between plates and solids."""

import pytest

mujoco = pytest.importorskip("mujoco")

from control.mujoco import Simulation, attach  # noqa: E402
from rom import Cylinder, TouchedSegment  # noqa: E402

TENSIONS = 27.592163, 2.983223
CENTRE, RADIUS = (0.046521, 0.028819, -0.003569), 0.015657
SCENE = """
<mujoco>
  <option timestep="0.001" gravity="0 0 0"/>
  <worldbody>
    <body name="palm"/>
    <geom type="cylinder" size="{radius} 0.1" pos="{centre}" zaxis="1 0 0" friction="0 0 0"/>
  </worldbody>
</mujoco>
"""


def test_a_plate_that_meets_a_cylinder_fast_presses_as_its_rod_says():
    """With several points of one contact, MuJoCo 4.0 leaves the plate 1 mm inside, with 3 % more force."""
    rod = TouchedSegment.load().rod
    spec = mujoco.MjSpec.from_string(SCENE.format(radius=RADIUS, centre=" ".join(map(str, CENTRE))))
    finger = attach(spec, rod, "palm")
    simulation = Simulation(spec.compile(), [finger], rate=200.0)
    simulation.pull(0, TENSIONS)
    simulation.advance(0.5)
    object_ = Cylinder(centre=CENTRE, radius=RADIUS, axis=(1, 0, 0), direction=(0, 1, 0), distances=(-0.01, 0.02))
    expected = float(TouchedSegment(rod=rod, obstacle=object_).evaluate([*TENSIONS, 0.0]).contact_force)
    assert simulation.contact_forces()[0] == pytest.approx(expected, rel=2e-3)
    assert simulation.data.contact.dist.min() > -1e-4
