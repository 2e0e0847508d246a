"""Options of a tracking controller."""

from dataclasses import dataclass

import numpy as np

from control.tracking.arguments import number, positive

LEAST, MOST = 1e-9, 1e9  # of noise, drift and effort, from which a filter's gains are computed


@dataclass(frozen=True, kw_only=True)
class TrackingOptions:
    """Options of a tracking controller.

    Attributes:
        period: time between rows of the path, and between commands [s].
        distance: of the object [m]; infinite without one.
        density: of the rubber [kg/m^3]; by default that of the scene's [gravity].
        friction: coefficient of the tendons in their guides, see `control.calibrate` [-]; the plan compensates for it.
        noise: standard deviation of the tip's readings [m].
        drift: standard deviation of the change of the model's error in a second [m/s^0.5].
        effort: weight of the square of a correction over that of the tip's error [-].
        correction: largest correction, as a displacement of the tip [m]. A plan whose simulated tip deviates more from
            the path is refused.
        pretension: share of the limits' range; the plan takes the tensions nearest to it [-]. Tendons that become slack
            in the plan excite vibration along the finger.
        feel: contact force above which a reading counts as contact [N].
        most_force: largest contact force in the plan's simulated motion, as means over a period [N]. The plan presses
            with at most half of it. Impacts have the rest: where they have more, the approach becomes slower. For
            another finger, and with feedback, it is not guaranteed; docs/accuracy.md has measured forces.
        margin: displacements of the object, nearer and farther, with which the simulated motion keeps `most_force`, too
            [m]. Errors of the tip's position act like these.
        approach: shortest time before contact in which the tip's planned speed towards the object falls to zero [s].
        settling: time constant with which readings of the contact force correct the plan [s].
    """

    period: float = 1e-3
    distance: float = np.inf
    density: float | None = None
    friction: float = 0.0
    noise: float = 2e-5
    drift: float = 3e-4
    effort: float = 3.0
    correction: float = 3e-3
    pretension: float = 0.2
    feel: float = 0.05
    most_force: float = np.inf
    margin: float = 1e-4
    approach: float = 0.02
    settling: float = 0.03

    def __post_init__(self) -> None:
        for name, unit in (("noise", "m"), ("drift", "m/s^0.5"), ("effort", "-")):
            number(name, getattr(self, name), LEAST, unit, highest=MOST)
        for name, unit in (("period", "s"), ("correction", "m"), ("feel", "N"), ("approach", "s"), ("settling", "s")):
            positive(name, getattr(self, name), unit)
        number("pretension", self.pretension, 0.0, highest=1.0)
        number("friction", self.friction, 0.0)
        number("margin", self.margin, 0.0, "m")
        positive("most_force", self.most_force, "N", infinite=True)
        number("distance", self.distance, 0.0, "m", infinite=True)
        if self.density is not None:
            positive("density", self.density, "kg/m^3")
