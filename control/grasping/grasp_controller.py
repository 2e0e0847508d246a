"""The controller of one finger of a gripper: it closes until it feels contact, locates the plane, squeezes and holds.

A pull is one control cycle: a reading comes in, the next tensions go out. Every usable reading in contact corrects the
distance d* of the plane, with a weight that falls with the sensor's noise. Without a usable reading, tensions stay.
"""

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from control.finger import Finger
from control.grasping.grasp_options import PAST, GraspOptions
from control.least_squares import CONVERGED, STATIONARY
from control.outcomes import listed
from control.problems import grip, rules
from rom.brief import brief
from rom.dataset.actuators import refuse_chambers

SMOOTH = 0.2  # largest weight of a new reading in the smoothed contact force, with a noisy sensor [-]
SURPRISED = 3  # consecutive unexpected readings before the next ones get full weight
AGAIN = 1.25  # times the lead tension when held contact is lost: its limit while the finger seeks contact again [-]
BEYOND = 1.5  # times the lead tension predicted for the target: above it, the sensor counts as failed [-]


@brief
@dataclass(frozen=True, kw_only=True)
class Pull:
    """One pull of one finger: its stage (approach, squeeze, hold), tensions [N], force felt [N], present d* [m]."""

    finger: int
    time: int
    stage: str
    tensions: list[float]
    contact_force: float
    distance: float | None


class Grip:
    """The controller of one finger; `step` takes a reading and returns the next tensions.

    Attributes:
        tensions: to be pulled now, shape (tensions,) [N].
        stage: approach, squeeze or hold.
        status: converged while it holds its target; or why not: "moving", "no_contact" (nothing felt up to the highest
            tension), "lost_contact" (what was held is gone), "sticks" (with a dead band: the force stays above the
            target, as less tension would press harder), "sensor_failed" (no usable reading, or one that does not answer
            to far more tension than the target should take), "unreachable" or "out_of_domain" (see control.finger);
            with the last three the tensions stay.
        confined: False, which its owner may set, while the object can move away from this finger, as others have not
            touched it yet. A finger that sticks then lowers its tension all the same.
        felt: contact force by the readings, smoothed [N].
        distance: the estimated distance d* of the plane, nan before touch [m].
        events: what happened, by pull: "touch", "surprise", "lost", "blind", "sees again", "does not answer", "target
            refused".

    Args:
        finger: what it controls, within its limits.
        target: contact force to hold [N].
        options: how.
    """

    def __init__(self, finger: Finger, target: float, options: GraspOptions):
        refuse_chambers(finger.model.scene, "a grasp, whose steps are of tensions,")
        self._finger, self._options = finger, options
        self.tensions = finger.lower.copy()
        self.stage, self.status, self.felt, self.distance = "approach", "moving", 0.0, np.nan
        self.events, self.pulls, self.confined = list[tuple[int, str]](), 0, True
        self._past: deque[np.ndarray] = deque(maxlen=PAST)
        self._target = self._aim = 0.0
        if not options.least_target < target < np.inf:
            raise ValueError(
                f"contact_force must be above {options.least_target:.3g} N to differ from no contact, got {target:g}"
            )
        self._trusted, self._held, self._cap, self._eased = np.nan, False, np.inf, np.inf
        self._touching = self._blind = self._surprised = self._missing = self._steady = self._seen = self._sticks = 0
        self._highest = float(finger.upper[finger.model.lead])
        self.target = target

    @property
    def target(self) -> float:
        """Contact force to hold [N]. A new one must be finite and above `GraspOptions.least_target`."""
        return self._target

    @target.setter
    def target(self, target: float) -> None:
        if not self._options.least_target < target < np.inf:
            if not self.events or self.events[-1][1] != "target refused":
                self._happened("target refused")
            return
        if target != self._target:
            if abs(target - self._target) > self._options.tolerance * target:
                self._steady = 0
            self._target, self._gain = target, self._options.gain(target)
            self._smooth = self._gain if self._options.noise == 0 else min(self._gain, SMOOTH)
            self._cap = self._most()
            if self.stage == "hold" and target > self._aim + target / self._options.squeeze_steps:
                self.stage = "squeeze"

    @property
    def period(self) -> float:
        """From step to step [s]."""
        return self._options.period

    @property
    def reason(self) -> str:
        """Why it does not hold its target, in a sentence with value and range; empty while it does or may yet."""
        options, finger = self._options, self._finger
        lower, upper = (listed(end) for end in (finger.lower, finger.upper))
        target, end = f"contact_force {self._target:g} N", f"{finger.upper[finger.model.lead]:g} N"
        nearest, farthest = (end[-1] for end in finger.model.limits)
        feel, held = f"{options.threshold:g} N", f"contact_force {self.felt:.4g} N"
        return {
            "no_contact": f"contact must be felt above {feel} at lead tensions up to {end}, nothing was",
            "lost_contact": f"contact must be felt again at lead tensions up to {self._highest:g} N, nothing was",
            "sticks": f"{held} felt must be {self._target:g} N, but the contact sticks: less tension presses harder",
            "sensor_failed": f"readings must be finite, less than {options.patience} pulls late and follow the "
            f"tensions, but after {self.pulls} pulls they are not",
            "unreachable": f"{target} at distance {self.distance:g} m must be met by tensions {lower} to {upper} N",
            "out_of_domain": f"contact_force {self.felt:g} N felt at tensions {listed(self.tensions)} N must be that "
            f"of a plane from {nearest:g} to {farthest:g} m",
        }.get(self.status, "")

    @property
    def done(self) -> bool:
        """True if it holds its target, or has failed."""
        return self.status != "moving"

    def step(self, felt: float, age: float = 0.0, tip: ArrayLike | None = None) -> np.ndarray:
        """Return the next tensions, shape (tensions,) [N], after a reading [N] of an age [s]; the tip is not used."""
        self.pulls += 1
        self._past.append(self.tensions)
        ages = age / self._options.period
        late = max(round(ages), 0) if ages < PAST else PAST  # an age of nan counts as too late
        if not np.isfinite(felt) or late >= self._options.patience or late >= len(self._past):
            self._see_nothing()
            return self.tensions
        if self._blind >= self._options.patience:
            self._happened("sees again")
            self.status = "moving"
        self._blind = 0
        if self.stage == "approach":
            self._approach(felt)
        if self.stage != "approach":
            self._squeeze(felt, self._past[-1 - late])
        return self.tensions

    def _happened(self, event: str) -> None:
        self.events.append((self.pulls, event))

    def _see_nothing(self) -> None:
        self._blind += 1
        if self._blind == self._options.patience:
            self._happened("blind")
            self.status = "sensor_failed"

    def _feels(self, felt: float, share: float = 1.0) -> bool:
        return felt > share * self._options.threshold

    def _most(self) -> float:
        """Lead tension above which the sensor counts as failed, once a force was held; before, infinite [N]."""
        if not np.isfinite(self._trusted):
            return np.inf
        return BEYOND * float(self._finger.hold(self._target, self._trusted).tensions[self._finger.model.lead])

    def _approach(self, felt: float) -> None:
        lead = self._finger.model.lead
        self._touching = self._touching + 1 if self._feels(felt) else 0
        if self._touching >= (1 if self._options.noise == 0 else 2):
            self._happened("touch")
            self.stage, self.status, self.distance, self.felt = "squeeze", "moving", np.nan, felt
            self._aim, self._missing, self._seen, self._eased = min(felt, self._target), 0, 0, np.inf
            return
        if self._touching:
            return  # a single such reading may be noise: wait
        if self.tensions[lead] >= self._highest:
            self.status = "no_contact" if self._highest >= self._finger.upper[lead] else "lost_contact"
            return
        self.tensions = self.tensions.copy()
        step = min(self._options.approach_step, self._finger.limits.rate * self._options.period)
        self.tensions[lead] = min(self.tensions[lead] + step, self._highest)

    def _squeeze(self, felt: float, then: np.ndarray) -> None:
        self._seen += 1
        gain = max(self._gain, min(1 / self._seen, self._options.fastest))
        weight = 1.0 if self._surprised >= SURPRISED else max(self._smooth, 1 / self._seen)
        self.felt += weight * (felt - self.felt)
        if self._lost(felt) or self._missing:
            return
        growing = self._aim < self._target
        self._aim = min(self._aim + self._target / self._options.squeeze_steps, self._target)
        if self.stage == "hold":
            self._aim = self._target
        believed = self._options.fastest if self._surprised >= SURPRISED else gain
        arguments = self._finger.compiled, then, felt, self.tensions, self._aim, self.distance, believed
        tensions, found = grip(*arguments, rules(1e-6))
        held, self.distance = found.status, found.distance
        self._judge(felt, found.expected)
        if np.isfinite(self._finger.limits.pad_pressure) and np.isfinite(self.distance):
            allowed = self._finger.hold(self._aim, self.distance, start=self.tensions)
            held, tensions = CONVERGED if allowed.converged else STATIONARY, allowed.tensions
        if tensions[self._finger.model.lead] > self._cap and self.stage == "hold":
            if self.status != "sensor_failed":
                self._happened("does not answer")
            self.status = "sensor_failed"
            return
        if held != CONVERGED:
            self.status = "unreachable" if np.isfinite(self.distance) else "out_of_domain"
            return
        if self._close_enough():
            tensions = self.tensions
        if self._stuck(tensions):
            tensions = self.tensions
        change = self._finger.limits.rate * self._options.period
        change_wanted = tensions - self.tensions
        longest = float(np.abs(change_wanted).max())
        arrives = longest <= change
        self.tensions = tensions if arrives else self.tensions + change_wanted * (change / longest)
        if self.stage == "squeeze" and not growing and self._aim == self._target and arrives:
            self.stage = "hold"
        wide = 2 if self.status == "converged" else 1  # a finger that holds may deviate by twice the tolerance
        near = abs(self.felt - self._target) <= wide * self._options.tolerance * self._target
        self._steady = self._steady + 1 if self.stage == "hold" and near else 0
        steady = min(1 / self._smooth, PAST)
        self.status = "converged" if self._steady >= steady else "sticks" if self._sticks >= steady else "moving"
        if self.status == "converged" and not np.isfinite(self._trusted):
            self._trusted, self._held = self.distance, True
            self._cap = self._most()

    def _close_enough(self) -> bool:
        """True if the felt force needs no correction; a force above the aim in a squeeze waits for the aim to grow."""
        band = self._options.dead_band * self._target
        return band > 0 and min(self._aim, self._target - band) <= self.felt <= self._target + band

    def _stuck(self, tensions: np.ndarray) -> bool:
        """True if the force grows with less tension: a finger that sticks gets longer, and presses harder."""
        lead = self._finger.model.lead
        lowers = self.confined and self._options.dead_band > 0 and tensions[lead] < self.tensions[lead]
        self._eased = min(self._eased, self.felt) if lowers else np.inf
        sticks = lowers and self.felt > self._eased + 3 * self._smooth * self._options.noise
        self._sticks = self._sticks + 1 if sticks else 0
        return sticks

    def _lost(self, felt: float) -> bool:
        """True if contact is lost: then it closes again, but not much beyond where it held something."""
        self._missing = 0 if self._feels(felt, 0.5) else self._missing + 1  # half of the threshold for first contact
        if self._missing < (1 if self._options.noise == 0 else 2 * SURPRISED):
            return False
        self._happened("lost")
        if self._held:
            lead = self._finger.model.lead
            self._highest = min(AGAIN * float(self.tensions[lead]), float(self._finger.upper[lead]))
        self.stage, self.status, self._touching, self.distance = "approach", "moving", 0, np.nan
        return True

    def _judge(self, felt: float, expected: float) -> None:
        """Count consecutive readings far from the expected force: something slipped, or moved."""
        wide = 6 * self._options.noise + 0.1 * self._target
        self._surprised = self._surprised + 1 if abs(felt - expected) > wide else 0  # nan: no surprise
        if self._surprised == (1 if self._gain == 1 else SURPRISED) and self.stage == "hold":
            self._happened("surprise")
