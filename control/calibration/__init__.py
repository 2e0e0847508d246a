"""A finger's parameters, fitted to a log of measurements."""

from control.calibration.calibrate import CalibrationOptions, calibrate
from control.calibration.calibration import Calibration

__all__ = ["Calibration", "CalibrationOptions", "calibrate"]
