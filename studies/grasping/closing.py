"""Fingers that wait for each other at a gentle touch, look what they have found, and squeeze together."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from control import Gripper
from control.grasping.grasp_controller import Grip

GENTLY = 0.4  # of the held force, with which fingers wait for each other [-]
SAFE = 0.9  # share of the force that crushes: readings of a growing force are late [-]
HOLDS = "converged", "sticks"  # statuses of a finger that presses at least with its target
SQUEEZE = 0.6  # from there to the held force [s]


@dataclass
class Closing:
    """Targets of contact forces, from touch to hold.

    Attributes:
        wanted: contact forces in the end, shape (fingers,) [N]; `share` of them are the targets now [-].
        most: force that crushes it [N]; no finger squeezes or lifts that feels more than SAFE of it.
        half_widths: distances of the faces from the solid's centre, shape (fingers,) [m]; nan if they are unknown.
        uncertain: largest error of the position of its faces [m].
        off_centre: largest distance of its centre from the gripper's axis [m], which three fingers measure.
        planned: distance of its centre above which fingers do not squeeze, but are to close again about the centre [m].
        doubt: why not to squeeze or to lift; empty if there is no reason.
        again: whether fingers are to close again.
    """

    gripper: Gripper
    grips: list[Grip]
    wanted: np.ndarray
    most: float = np.inf
    half_widths: np.ndarray | float = np.nan
    uncertain: float = np.inf
    off_centre: float = np.inf
    planned: float = np.inf
    share: float = GENTLY
    squeezing: bool = field(default=False, init=False)
    again: bool = field(default=False, init=False)
    doubt: str = field(default="", init=False)

    @property
    def ended(self) -> bool:
        """True if all fingers hold their forces, or are not to go on."""
        return bool(self.doubt) or self.again or (self.share >= 1.0 and all(grip.done for grip in self.grips))

    def targets(self) -> np.ndarray:
        """Contact forces from now on, shape (fingers,) [N]: all squeeze once all have touched."""
        confined = all(grip.stage != "approach" for grip in self.grips)
        for grip in self.grips:
            grip.confined = confined
        self.doubt = self.doubt or self.doubt_now()
        if self.doubt or self.again:
            return self.share * self.wanted
        if self.squeezing or all(grip.stage == "hold" for grip in self.grips):
            self.again = not self.squeezing and float(np.linalg.norm(self.centre)) > self.planned
            self.squeezing, self.doubt = True, "" if self.again else self.misplaced()
            if not self.ended:
                self.share = min(self.share + (1 - GENTLY) * self.grips[0].period / SQUEEZE, 1.0)
        return self.share * self.wanted

    def doubt_now(self) -> str:
        """Which finger has failed or nearly crushes the solid; empty if none."""
        felt = [grip.felt for grip in self.grips]
        worst = int(np.argmax(felt))
        if felt[worst] > SAFE * self.most:
            return f"finger {worst} presses with {felt[worst]:.3g} N, near the admissible {self.most:.3g} N"
        return self.failed() if any(grip.done and grip.status not in HOLDS for grip in self.grips) else ""

    def failed(self) -> str:
        """Which fingers do not hold, and why; one that sticks presses harder than its target, and holds."""
        return ", ".join(f"finger {k}: {grip.status}" for k, grip in enumerate(self.grips) if grip.status not in HOLDS)

    @property
    def centre(self) -> np.ndarray:
        """Centre of the solid from the gripper's axis, as three fingers measure it; nan for fewer, shape (2,) [m]."""
        return self.gripper.locate(self.distances + self.half_widths)[0]

    @property
    def distances(self) -> np.ndarray:
        """Distances of faces from open fingers, as measured, shape (fingers,) [m]."""
        return np.array([grip.distance for grip in self.grips])

    def misplaced(self) -> str:
        """Which face is not where it should be, so that it is another, or has moved or tipped."""
        off = self.distances - (self.gripper.radius - self.half_widths)
        worst = int(np.argmax(np.abs(off)))
        if abs(off[worst]) > self.uncertain:
            return f"finger {worst} finds its face {1000 * abs(off[worst]):.1f} mm from where it should be"
        away = float(np.linalg.norm(self.centre))
        if away > self.off_centre:
            return f"the solid is {1000 * away:.1f} mm from the gripper's axis"
        return ""
