"""control: controllers of tendon-driven fingers; they need a trained model (rom) and nothing below it.

This is not python-control, which is also imported as `control`: run from the checkout, or install editable.
"""

from control.finger import Finger
from control.grip import GraspOptions
from control.gripper import Grasp, Gripper
from control.motion import Limits, Motion
from control.plant import Flaws, Plant, SimulatedPlant
from control.targets import Object, Targets

__all__ = [
    "Finger",
    "Flaws",
    "Grasp",
    "GraspOptions",
    "Gripper",
    "Limits",
    "Motion",
    "Object",
    "Plant",
    "SimulatedPlant",
    "Targets",
]
