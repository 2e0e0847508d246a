"""control: controllers of tendon-driven fingers; they need a trained model (rom) and nothing below it.

This is not python-control, which is also imported as `control`: run from the checkout, or install editable.
"""

from control.finger import Finger, Motion
from control.gripper import Grasp, Gripper
from control.plant import Plant, SimulatedPlant

__all__ = ["Finger", "Grasp", "Gripper", "Motion", "Plant", "SimulatedPlant"]
