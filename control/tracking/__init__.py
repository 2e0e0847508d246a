"""The tip follows a path in time: a plan by the model's inverse and its dynamics, and feedback from tip readings."""

from control.tracking.options import TrackingOptions as TrackingOptions
from control.tracking.paths import circle as circle
from control.tracking.paths import eight as eight
from control.tracking.pid import PidController as PidController
from control.tracking.track import Track as Track
from control.tracking.track import track as track
from control.tracking.tracking_controller import TrackingController as TrackingController
