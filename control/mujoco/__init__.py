"""Fingers of trained rod elements in a MuJoCo scene, which simulates palm, gravity, friction and objects.

Needs the optional extra: pip install -e '.[mujoco]'.
"""

from rom.console.packages import require

require("mujoco")

from control.mujoco.attach import Attached, attach, attach_gripper  # noqa: E402
from control.mujoco.plant import MujocoPlant, plants  # noqa: E402
from control.mujoco.simulation import Simulation, SimulationStopped  # noqa: E402

__all__ = ["Attached", "MujocoPlant", "Simulation", "SimulationStopped", "attach", "attach_gripper", "plants"]
