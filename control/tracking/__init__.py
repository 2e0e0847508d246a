"""Tracking of a path in time: tensions planned by the inverse of the model and its dynamics, corrected by feedback."""

from control.tracking.options import TrackingOptions as TrackingOptions
from control.tracking.paths import circle as circle
from control.tracking.paths import eight as eight
from control.tracking.pid import PidController as PidController
from control.tracking.tracking_controller import TrackingController as TrackingController
