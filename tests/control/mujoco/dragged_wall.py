"""A finger before a wall on springs, and one under which the wall is dragged along."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from control.mujoco import Simulation, attach
from rom import Rod
from studies.grasping.task import STEP

DISTANCE = 0.013  # d of the wall [m]
LOADED = 0.1  # [N], with which contacts are looked at
DRAWN, DRAG = 0.004, 0.002  # how far the wall is drawn along [m], and how fast [m/s]
WALL = """
<mujoco>
  <option timestep="{step}" gravity="0 0 0"/>
  <worldbody>
    <body name="palm"/>
    <body name="wall" pos="0.05 {at} 0">
      <joint name="y" type="slide" axis="0 1 0" stiffness="{stiffness}" damping="{damping}"/>
      <joint name="z" type="slide" axis="0 0 1" stiffness="{along}" damping="{damping}"/>
      <geom type="box" size="0.05 0.005 0.05" mass="{mass}" friction="{friction} 0.001 0.0001" condim="4"/>
    </body>
  </worldbody>
  <actuator><position name="drag" joint="z" kp="{drag}"/></actuator>
</mujoco>
"""
STIFF, SOFT = 1e6, 500.0  # springs that hold the wall [N/m]
RINGS = 100.0  # rad/s, at which the wall would ring: slow for a step
DAMPED = {STIFF: 1.0, SOFT: 0.02}  # of critical damping [-]: what it takes is lost to a loop's work


def before_a_wall(rod: Rod, friction: float, stiffness: float = STIFF, dragged: bool = False) -> Simulation:
    """A finger before a wall on springs along y and z [N/m], or drawn along z instead."""
    mass = stiffness / RINGS**2
    text = WALL.format(
        step=STEP,
        at=0.005 + DISTANCE + 0.005,
        friction=friction,
        stiffness=stiffness,
        along=0.0 if dragged else stiffness,
        drag=stiffness if dragged else 0.0,
        damping=2 * DAMPED[stiffness] * RINGS * mass,
        mass=mass,
    )
    spec = mujoco.MjSpec.from_string(text)
    finger = attach(spec, rod, "palm")
    return Simulation(spec.compile(), [finger])


def sliding(rod: Rod, friction: float) -> dict[str, Any]:
    """A wall drawn along under a finger: angles at which contacts slide, faster than a tenth of the wall."""
    simulation = before_a_wall(rod, friction, dragged=True)
    for tension in (36.0, 35.0):  # let go a little it sticks, with friction to spare
        simulation.pull(0, (tension, 0.0))
        simulation.advance(simulation.time + 1.0)
    data = simulation.data
    angles, slips = [], []
    for k in range(round(DRAWN / DRAG / STEP)):
        data.ctrl[0] = DRAG * STEP * (k + 1)
        simulation.step()
        for row in data.contact.efc_address[data.contact.exclude == 0]:
            force, slip = data.efc_force[row : row + 3], data.efc_vel[row + 1 : row + 3]
            if force[0] > LOADED:
                angles.append(float(np.degrees(np.arctan2(np.linalg.norm(force[1:]), force[0]))))
                slips.append(float(np.linalg.norm(slip)))
    known, fast = np.array(angles), np.array(slips)
    slides = fast > 0.1 * DRAG
    limit = float(np.degrees(np.arctan(friction)))
    return {
        "friction": friction,
        "angle": limit,
        "sliding_least": float(known[slides].min()),
        "sliding_p5": float(np.percentile(known[slides], 5)),
        "sliding_median": float(np.median(known[slides])),
        "largest": float(known.max()),
    }
