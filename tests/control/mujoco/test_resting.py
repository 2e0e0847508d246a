"""Solids at rest on a table: against closed forms, and against MuJoCo, in which they do not move."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.distance import pdist
from scipy.spatial.transform import Rotation

mujoco = pytest.importorskip("mujoco")

from control.mujoco.resting import LEVEL, at_rest  # noqa: E402
from control.mujoco.solids import centre_of, half_width, random_solid  # noqa: E402

TALL, WIDE = 0.04, 0.02  # of a box [m]
CRITICAL = np.degrees(np.arctan(WIDE / TALL))  # tilt at which its centre is above its edge
FALLING = """
<mujoco>
  <option timestep="0.001"/>
  <asset><mesh name="object" vertex="{}" inertia="exact"/></asset>
  <worldbody><geom type="plane" size="0 0 0.1" solref="0.004 1"/>
    <body name="object"><freejoint/><geom type="mesh" mesh="object" solref="0.004 1" mass="0.1"/></body>
  </worldbody>
</mujoco>
"""


def mesh(seed: int):
    return random_solid(np.random.default_rng(seed), "mesh")


def tilted_box(degrees: float):
    signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
    corners = Rotation.from_euler("y", degrees, degrees=True).apply(signs * [WIDE / 2, 0.015, TALL / 2])
    return replace(mesh(0), corners=corners - [0.0, 0.0, corners[:, 2].min()])


@pytest.mark.parametrize(("tilt", "height"), [(0.9 * CRITICAL, TALL), (1.1 * CRITICAL, WIDE)])
def test_a_tilted_box_falls_to_the_side_of_its_centre(tilt, height):
    rested = at_rest(tilted_box(tilt))
    assert np.ptp(rested.corners[:, 2]) == pytest.approx(height, abs=1e-12)
    assert rested.grasped == pytest.approx(height / 2, abs=1e-12)


def test_a_balanced_solid_falls():
    """An octahedron on a corner, and a box on an edge below its centre: as by the least touch."""
    tips = 0.015 * np.concatenate([np.eye(3), -np.eye(3)])
    octahedron = at_rest(replace(mesh(0), corners=tips + np.array([0.0, 0.0, 0.015])))
    assert octahedron.grasped == pytest.approx(0.015 / np.sqrt(3), rel=1e-12)
    assert at_rest(tilted_box(CRITICAL)).grasped in (pytest.approx(TALL / 2), pytest.approx(WIDE / 2))


def test_meshes_roll_until_they_stand_on_a_slope_or_cannot_get_lower():
    rolled = 0
    for seed in range(60):
        drawn, rested = mesh(seed), at_rest(mesh(seed))
        assert pdist(rested.corners) == pytest.approx(pdist(drawn.corners), abs=1e-12)
        centre = centre_of(rested.corners)
        assert centre == pytest.approx([0.0, 0.0, rested.grasped], abs=1e-12)
        assert centre[2] <= drawn.grasped + 1e-12 and abs(rested.corners[:, 2].min()) < 1e-9
        steep = np.arctan(rested.tipping_force / (rested.mass * 9.80665))
        if rested.grasped < drawn.grasped - 1e-9:
            rolled += 1
        else:
            assert steep >= LEVEL
        assert steep > 0
    assert 0 < rolled < 60


def test_in_mujoco_a_mesh_at_rest_does_not_move():
    for seed in range(30):
        rested = at_rest(mesh(seed))
        vertices = " ".join(f"{x:.9g}" for x in rested.corners.ravel())
        model = mujoco.MjModel.from_xml_string(FALLING.format(vertices))
        data = mujoco.MjData(model)
        mujoco.mj_step(model, data, 1000)
        turned = 2 * np.arccos(min(abs(data.qpos[3]), 1.0))
        assert turned < np.radians(0.3) and np.linalg.norm(data.qpos[:2]) < 1e-4


def test_the_half_width_of_a_box_is_its_perimeter_over_2_pi():
    box = tilted_box(0.0)
    assert half_width(box.corners, 0.01) == pytest.approx(2 * (WIDE + 0.03) / (2 * np.pi))
