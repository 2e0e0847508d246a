"""A table, a solid on it, and a gripper above on a mount of six axes."""

from __future__ import annotations

import mujoco
import numpy as np

from control.grasping.gripper import Gripper
from control.mujoco.attach import attach_gripper
from control.mujoco.simulation import Simulation
from control.mujoco.solids import Solid
from rom import Rod

STEP = 0.001  # [s]
# Time constant of contacts of table and solid, in steps; MuJoCo's default of 20 ms lets a solid sink in by 0.3 mm, and
# tip over on a small foot.
HARD = 4
AXES = ("x", "y", "z", "roll", "pitch", "yaw")
# Armature [kg, kg m^2], stiffness [N/m, N m/rad] and damping of the mount's axes along and about x, y, z, for an arm
# with a time constant of 30 ms.
MOUNT = {"slide": (2.0, 2e4, 400.0), "hinge": (0.005, 50.0, 1.0)}
SCENE = """
<mujoco>
  <option timestep="{step}"/>
  <visual>
    <headlight ambient="0.4 0.4 0.4" diffuse="0.5 0.5 0.5" specular="0.1 0.1 0.1"/>
    <global offwidth="1280" offheight="960"/><map znear="0.02"/><rgba haze="0.93 0.95 0.97 1"/>
  </visual>
  <asset>
    <texture name="table" type="2d" builtin="checker" rgb1=".96 .96 .95" rgb2=".88 .88 .86" width="256" height="256"/>
    <texture type="skybox" builtin="gradient" rgb1="1 1 1" rgb2=".93 .95 .97" width="64" height="384"/>
    <material name="table" texture="table" texuniform="true" texrepeat="20 20" specular="0" reflectance="0"/>
    {asset}
  </asset>
  <worldbody>
    <light type="directional" pos="0.08 -0.1 0.8" dir="-0.08 0.1 -0.8" diffuse="0.4 0.4 0.4" specular="0.2 0.2 0.2"/>
    <geom name="table" type="plane" size="0 0 0.1" friction="1" solref="{hard} 1" material="table"/>
    <body name="object" pos="{x} {y} {z}" quat="{quat}">
      <freejoint/>
      <geom name="object" {geom} mass="{mass}" friction="{friction} 0.001 0.0001" condim="4" solref="{hard} 1"
        rgba="0.2 0.5 0.8 1"/>
    </body>
    <body name="palm" pos="0 0 {palm}" gravcomp="1">
      {joints}
      <geom type="cylinder" size="0.035 0.004" pos="0 0 0.005" mass="0.5" rgba="0.35 0.37 0.42 1"/>
    </body>
  </worldbody>
  <actuator>{actuators}</actuator>
</mujoco>
"""


def table(
    gripper: Gripper,
    rod: Rod,
    solid: Solid,
    error: np.ndarray,
    turn: float = 0.0,
    step: float = STEP,
) -> Simulation:
    """Simulate a solid on a table under a gripper, whose fingers touch it at the height of the grasp.

    Args:
        gripper: any number of fingers.
        rod: model of every finger.
        solid: on the table.
        error: of the gripper's position above it, shape (3,) [m].
        turn: of the solid about its axis [rad].
        step: of the simulation [s].

    Returns:
        A simulation whose controls are the mount's axes (AXES) [m, rad], with bodies "palm" and "object".
    """
    joints, actuators = "", ""
    for k, name in enumerate(AXES):
        kind, axis = ("slide", "hinge")[k // 3], " ".join(str(int(i == k % 3)) for i in range(3))
        heavy, stiff, damped = MOUNT[kind]
        joints += f'<joint name="{name}" type="{kind}" axis="{axis}" armature="{heavy}"/>'
        actuators += f'<position name="{name}" joint="{name}" kp="{stiff}" kv="{damped}" timeconst="0.03"/>'
    vertices = " ".join(f"{x:.7g}" for x in solid.corners.ravel())
    size = " ".join(map(str, solid.size))
    text = SCENE.format(
        step=step,
        hard=HARD * step,
        asset="" if size else f'<mesh name="object" vertex="{vertices}" inertia="exact"/>',
        palm=solid.grasped + tip_height(gripper, rod, solid.radius) + error[2],
        joints=joints,
        x=error[0],
        y=error[1],
        z=solid.middle + 1e-5,
        quat=f"{np.cos(turn / 2)} 0 0 {np.sin(turn / 2)}",
        geom=f'type="{solid.shape}" size="{size}"' if size else 'type="mesh" mesh="object"',
        mass=solid.mass,
        friction=solid.friction,
        actuators=actuators,
    )
    spec = mujoco.MjSpec.from_string(text)
    fingers = attach_gripper(spec, rod, "palm", len(gripper.fingers), gripper.radius)
    return Simulation(spec.compile(), fingers)


def tip_height(gripper: Gripper, rod: Rod, radius: float) -> float:
    """Distance from the palm down to the plate of a free finger that touches a face at a radius [m]."""
    return closing_at(gripper, rod, radius)[1]


def closing_at(gripper: Gripper, rod: Rod, radius: float) -> tuple[float, float, float]:
    """Lead tension of a free finger at a radius [N]; distances from the palm down to its inner edge and its end [m]."""
    finger, lead = gripper.fingers[0], gripper.model.lead
    leads = np.linspace(finger.lower[lead], finger.upper[lead], 200)
    tensions = np.zeros((len(leads), len(rod.names)))
    tensions[:, lead] = leads
    inner, outer = np.transpose([edges(rod, one) for one in tensions], (1, 2, 0))
    at, ends = gripper.radius - radius + rod.half_lengths[1], np.maximum(inner[0], outer[0])
    tension, edge, end = (float(np.interp(at, inner[1], one)) for one in (leads, inner[0], ends))
    return tension, edge, end


def edges(rod: Rod, tensions: np.ndarray) -> np.ndarray:
    """Inner and outer edge of the last plate of a free finger at tensions, shape (2, 3), in the clamp's axes [m]."""
    placed, (along, inwards, _) = rod.place(tensions), rod.half_lengths
    return placed.centres[-1] + np.array([[along, inwards, 0.0], [along, -inwards, 0.0]]) @ placed.rotations[-1].T
