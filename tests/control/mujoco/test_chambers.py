"""A finger with chambers in MuJoCo: pressures follow at rates of their own, to the rod's own pose."""

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from control.mujoco import Simulation, attach  # noqa: E402

SCENE = """
<mujoco>
  <option timestep="0.001" gravity="0 0 0"/>
  <worldbody><body name="palm"><geom type="sphere" size="0.01" mass="1" contype="0" conaffinity="0"/></body></worldbody>
</mujoco>
"""
LOADS = np.array([2.0, 4e5, 0.0])


def finger_in(rod, rate):
    spec = mujoco.MjSpec.from_string(SCENE)
    finger = attach(spec, rod, "palm", relaxation=0.1, density=1100.0)
    return Simulation(spec.compile(), [finger], rate)


def test_pressure_bends_it_as_the_rod_alone(chambered):
    simulation = finger_in(chambered, [100.0, 2e6, 2e6])
    simulation.pull(0, LOADS)
    simulation.advance(0.1)
    assert simulation.tensions[0] == pytest.approx([2.0, 2e5, 0.0], rel=0.02)  # half of the way, in Pa per s
    simulation.advance(2.0)
    clamp, plate = (simulation.data.body(name) for name in ("finger clamp", simulation.fingers[0].plates[0]))
    found = (plate.xpos - clamp.xpos) @ clamp.xmat.reshape(3, 3)
    expected = chambered.place(LOADS).centres[0]
    assert expected[1] > 1e-3 and np.abs(found - expected).max() < 0.02 * expected[1]


def test_a_rate_for_all_loads_and_a_pressure_out_of_range_are_refused(chambered):
    with pytest.raises(ValueError, match=r"rate must be one for each of F1, p1, p2, got 500.0"):
        finger_in(chambered, 500.0)
    with pytest.raises(ValueError, match=r"tensions must be from \[0.0, 0.0, 0.0\] to \[10.0, .* N, Pa, got"):
        finger_in(chambered, [100.0, 2e6, 2e6]).pull(0, [1.0, 6e5, 0.0])
