"""Fingers in a MuJoCo scene, each the trained map of its rubber: palm, gravity, friction and objects are MuJoCo's.

Needs the optional extra: pip install 'fingerfem[mujoco]'.
"""

from control.mujoco.attach import Attached, attach, attach_gripper
from control.mujoco.plant import MujocoPlant, plants
from control.mujoco.simulation import Simulation, SimulationStopped

__all__ = ["Attached", "MujocoPlant", "Simulation", "SimulationStopped", "attach", "attach_gripper", "plants"]
