"""Options of a grasp: thresholds, rates and tolerances of the controller of a finger."""

from dataclasses import dataclass

import numpy as np

PAST = 256  # pulls that are remembered: a reading that is older cannot be used
DISTINCT = 1.3  # smallest ratio of a target to the force that counts as contact [-]


@dataclass(frozen=True, kw_only=True)
class GraspOptions:
    """Options of a grasp.

    Attributes:
        noise: standard deviation of the force sensor [N].
        feel: a force above this is contact [N]; three standard deviations of the noise if that is more.
        approach_step: most that the lead tension grows in a pull while nothing is felt [N]. The force at first contact
            is up to a fifth of this. Each pull of sensor delay adds up to another fifth.
        squeeze_steps: pulls from touch to the held force.
        tolerance: largest relative deviation from the target at which the force counts as held [-].
        period: from pull to pull [s], for ages of readings and rates of tensions.
        settling: time in which a finger follows its tensions [s]; a reading's weight is at most period / settling [-].
        dead_band: a force this near its target is not corrected, at most the tolerance [-]. It is needed with friction:
            when the tension change reverses, the contact sticks, and the force first changes in the wrong direction.
        patience: pulls without a usable reading before a sensor counts as failed.
        pulls: largest number of pulls per finger.
    """

    noise: float = 0.0
    feel: float = 0.05
    approach_step: float = 2.0
    squeeze_steps: int = 3
    tolerance: float = 0.005
    period: float = 1e-3
    settling: float = 0.0
    dead_band: float = 0.0
    patience: int = 20
    pulls: int = 5000

    def __post_init__(self) -> None:
        for name in ("feel", "approach_step", "squeeze_steps", "tolerance", "period", "patience", "pulls"):
            if not 0 < getattr(self, name) < np.inf:
                raise ValueError(f"{name} must be above 0, got {getattr(self, name)}")
        if not 0 <= self.noise < np.inf:
            raise ValueError(f"noise must be at least 0 N, got {self.noise}")
        for name, unit in (("settling", " s"), ("dead_band", "")):
            if not 0 <= getattr(self, name) < np.inf:
                raise ValueError(f"{name} must be at least 0{unit}, got {getattr(self, name)}")
        if self.dead_band > self.tolerance:
            raise ValueError(f"dead_band must be at most the tolerance, {self.tolerance:g}, got {self.dead_band:g}")

    @property
    def threshold(self) -> float:
        """Force above which a reading is contact [N]."""
        return max(self.feel, 3 * self.noise)

    @property
    def least_target(self) -> float:
        """Contact force above which a target differs from no contact [N]."""
        return DISTINCT * self.threshold

    def gain(self, target: float) -> float:
        """Weight of a reading's difference from the expected force [-]; the held force has noise of tolerance / 3."""
        if self.noise == 0:
            return self.fastest
        return float(np.clip(2 * (self.tolerance * target / (3 * self.noise)) ** 2, 1 / PAST, self.fastest))

    @property
    def fastest(self) -> float:
        """Largest weight of one reading [-]: period / settling, at most 1."""
        return self.period / max(self.period, self.settling)
