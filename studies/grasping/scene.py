"""A table, an object on it, and a gripper of three fingers on a mount of six axes."""

from __future__ import annotations

import mujoco
import numpy as np

from control.mujoco import Simulation, attach_gripper
from rom import SegmentMap
from studies.grasping.objects import Thing

STEP = 0.001  # [s]
AXES = ("x", "y", "z", "roll", "pitch", "yaw")
SCENE = """
<mujoco>
  <option timestep="{step}" cone="elliptic" impratio="100"/>
  <asset>{asset}</asset>
  <worldbody>
    <geom name="table" type="plane" size="1 1 0.1" friction="1"/>
    <body name="palm" pos="0 0 {palm}" gravcomp="1">
      {joints}
      <geom type="cylinder" size="0.035 0.004" pos="0 0 0.005" mass="0.5"/>
    </body>
    <body name="object" pos="{x} {y} {z}" quat="{quat}">
      <freejoint/>
      <geom name="object" {geom} mass="{mass}" friction="{friction} 0.001 0.0001" condim="4"/>
    </body>
  </worldbody>
  <actuator>{actuators}</actuator>
</mujoco>
"""


def simulation(
    segment: SegmentMap, thing: Thing, palm: float, place: np.ndarray, turn: float, step: float = STEP
) -> Simulation:
    """An object that stands at a place, shape (2,) [m], turned [rad], under a palm at a height [m]."""
    mesh = not thing.size
    vertices = " ".join(f"{x:.7g}" for x in thing.corners.ravel())
    joints, actuators = "", ""
    for k, name in enumerate(AXES):
        kind, axis = ("slide", "hinge")[k // 3], " ".join(str(int(i == k % 3)) for i in range(3))
        heavy, stiff, damped = (2.0, 2e4, 400.0) if k < 3 else (0.005, 50.0, 1.0)  # 15 Hz, as an arm
        joints += f'<joint name="{name}" type="{kind}" axis="{axis}" armature="{heavy}"/>'
        actuators += f'<position name="{name}" joint="{name}" kp="{stiff}" kv="{damped}" timeconst="0.03"/>'
    text = SCENE.format(
        step=step,
        asset=f'<mesh name="object" vertex="{vertices}" inertia="exact"/>' if mesh else "",
        palm=palm,
        joints=joints,
        x=place[0],
        y=place[1],
        z=thing.middle + 1e-5,
        quat=f"{np.cos(turn / 2)} 0 0 {np.sin(turn / 2)}",
        geom='type="mesh" mesh="object"' if mesh else f'type="{thing.shape}" size="{" ".join(map(str, thing.size))}"',
        mass=thing.mass,
        friction=thing.friction,
        actuators=actuators,
    )
    spec = mujoco.MjSpec.from_string(text)
    fingers = attach_gripper(spec, segment, "palm")
    return Simulation(spec.compile(), fingers)
