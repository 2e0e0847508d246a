"""control: controllers of tendon-driven fingers; they need a trained model (rom) and nothing below it.

This is not python-control, which is also imported as `control`: run from the checkout, or install editable.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from control.calibration.calibrate import CalibrationOptions, calibrate
    from control.calibration.calibration import Calibration
    from control.finger import Finger
    from control.grasping.grasp_controller import Grip
    from control.grasping.grasp_forces import Object, Targets
    from control.grasping.grasp_options import GraspOptions
    from control.grasping.gripper import Grasp, Gripper
    from control.loop import run
    from control.motion import Limits, Motion
    from control.plant import Flaws, MovingPlant, Plant, SimulatedPlant
    from control.tracking.options import TrackingOptions
    from control.tracking.tracking_controller import TrackingController

_HOMES = {
    "Calibration": "calibration.calibration",
    "CalibrationOptions": "calibration.calibrate",
    "Finger": "finger",
    "Flaws": "plant",
    "Grasp": "grasping.gripper",
    "GraspOptions": "grasping.grasp_options",
    "Grip": "grasping.grasp_controller",
    "Gripper": "grasping.gripper",
    "Limits": "motion",
    "Motion": "motion",
    "MovingPlant": "plant",
    "Object": "grasping.grasp_forces",
    "Plant": "plant",
    "SimulatedPlant": "plant",
    "Targets": "grasping.grasp_forces",
    "TrackingController": "tracking.tracking_controller",
    "TrackingOptions": "tracking.options",
    "calibrate": "calibration.calibrate",
    "run": "loop",
}
__all__ = [
    "Calibration",
    "CalibrationOptions",
    "Finger",
    "Flaws",
    "Grasp",
    "GraspOptions",
    "Grip",
    "Gripper",
    "Limits",
    "Motion",
    "MovingPlant",
    "Object",
    "Plant",
    "SimulatedPlant",
    "Targets",
    "TrackingController",
    "TrackingOptions",
    "calibrate",
    "run",
]


def __getattr__(name: str) -> Any:
    """Import on first use: a command can be interrupted before it compiles."""
    if name not in _HOMES:
        raise AttributeError(f"module 'control' has no attribute {name!r}")
    return getattr(import_module(f"control.{_HOMES[name]}"), name)
