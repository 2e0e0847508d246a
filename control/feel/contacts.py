"""Feel a contact of known objects, or one unknown force.

A tendon's shortening is measured by its motor, and its tension by a load cell or the motor's current. The estimate is
the least sum of squares of all deviations, over their standard deviations (control/native/feel.c). Tensions are
variables too, so that it does not matter which of both the motors set.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from control.feel.felt import Felt, Noise, usual
from control.feel.unknowns import ITERATIONS, Unknowns
from control.least_squares import CONVERGED, OUTSIDE, STATIONARY
from control.outcomes import STATUSES, beyond, not_finite
from rom.rod.rod import Rod
from rom.rod.touched_rod import TouchedRod

FORCE = "position", "force_y", "force_z"  # unknowns of a force across a finger
BEGIN = 0.7  # of the finger's length: where the search for a force begins [-]
FAR = 5.0  # standard deviations by which a measured tension may lie outside the trained ones [-]
REASONS = {
    "out_of_domain": "the measurements must be met within the trained domain, but the nearest state is outside it",
    "iteration_limit": f"the measurements were not met within {ITERATIONS} evaluations from a start: give a hint",
}


class _Feeling:
    """The common part of both kinds of unknowns."""

    def __init__(self, unknowns: Unknowns, noise: Noise, begin: np.ndarray | None = None):
        self._unknowns, self._noise, self._begin = unknowns, noise, begin

    def feel(
        self,
        tensions: ArrayLike,
        shortenings: ArrayLike,
        expected: Mapping[str, tuple[float, float]] | None = None,
        hint: Felt | ArrayLike | None = None,
    ) -> Felt:
        """Estimate the unknowns from one measurement of all tendons.

        Args:
            tensions: measured, shape (t,) [N].
            shortenings: measured, shape (t,) [m]; zero where the finger is straight and no tendon is pulled.
            expected: values of unknowns by name with their standard deviations; 0 if a value is known. The others
                are expected to be evenly distributed over their ranges.
            hint: where the search begins: the last estimate, or values of the k unknowns, shape (k,).

        Raises:
            ValueError: arrays of the wrong shape, noise that is not above 0, or expected values outside their ranges.
        """
        unknowns = self._unknowns
        names, k, t = unknowns.names, len(unknowns.names), unknowns.ranges.shape[1] - len(unknowns.names)
        pulled, shorter = (np.ascontiguousarray(one, float) for one in (tensions, shortenings))
        if pulled.shape != (t,) or shorter.shape != (t,):
            raise ValueError(f"tensions and shortenings must have shape ({t},), got {pulled.shape} and {shorter.shape}")
        if isinstance(hint, Felt):
            hint = hint.values
        start = self._begin if hint is None else hint
        begin = None if start is None else np.ascontiguousarray(start, float)
        if begin is not None and begin.shape != (k,):
            raise ValueError(f"hint must be {', '.join(names)}, got shape {begin.shape}")
        ranges, values, deviations = unknowns.expected(expected or {})
        pulled_by, shorter_by = self._noise.deviations(pulled, float(unknowns.rod.struct.shortening_error))
        lower, upper = unknowns.ranges[:, :t] + FAR * pulled_by * [[-1.0], [1.0]]
        reason = not_finite("shortenings", shorter, "m") or beyond("tensions", pulled, lower, upper, "N")
        if reason:
            return self._nothing(reason)
        measured = pulled, pulled_by, shorter, shorter_by, values, deviations
        free = int(np.count_nonzero(ranges[0, t:] < ranges[1, t:]))
        feeling, arrays = unknowns.solved(measured, ranges, begin, usual(t - free))
        unseen = arrays["visible"] < 1.0
        freedom = t - free + int(unseen.sum())
        status = STATUSES.get(CONVERGED if feeling.status == STATIONARY else feeling.status, "iteration_limit")
        status = status if feeling.inside else STATUSES[OUTSIDE]
        return Felt(
            names=names,
            values=arrays["variables"][t:],
            covariance=arrays["covariance"][t:, t:],
            contact_forces=arrays["forces"],
            force_covariance=arrays["force_covariance"],
            tensions=arrays["variables"][:t],
            unseen=arrays["axes"][unseen] * deviations,
            chi_square=float(feeling.chi_square),
            freedom=freedom,
            other=arrays["other"][t:] if not unseen.any() and feeling.other_chi_square <= usual(freedom) else None,
            status=status,
            iterations=int(feeling.evaluations),
            reason=REASONS.get(status, ""),
        )

    def _nothing(self, reason: str) -> Felt:
        """No estimate."""
        k, m = len(self._unknowns.names), self._unknowns.touching.count if self._unknowns.touching else 0
        t = self._unknowns.ranges.shape[1] - k
        return Felt(
            names=self._unknowns.names,
            values=np.full(k, np.nan),
            covariance=np.full((k, k), np.nan),
            contact_forces=np.full(m, np.nan),
            force_covariance=np.full((m, m), np.nan),
            tensions=np.full(t, np.nan),
            unseen=np.diag(np.ptp(self._unknowns.ranges[:, t:], axis=0)),
            chi_square=np.nan,
            freedom=0,
            status=STATUSES[OUTSIDE],
            iterations=0,
            reason=reason,
        )


class KnownObjects(_Feeling):
    """Estimates distances and contact forces of objects with known shapes and directions.

    `model.contact_forces` returns the contact positions.

    Args:
        model: the finger before them, with m objects.
        noise: of the measurements.

    Example:
        >>> felt = KnownObjects(rom.load(), Noise(shortening=2e-5, tension=0.05)).feel([50.0, 5.0], [0.0085, 0.0028])
        >>> felt.contact_forces, felt.force_deviations  # doctest: +SKIP
    """

    def __init__(self, model: TouchedRod, noise: Noise):
        ranges = np.array([[one.lower, one.upper] for one in model.parameters]).T
        super().__init__(Unknowns(tuple(model.distance_names), model.rod, ranges, model.touching), noise)
        self.model, self.noise = model, noise

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle and copy by the arguments."""
        return type(self), (self.model, self.noise)


class UnknownForce(_Feeling):
    """Estimates one force across the finger, without friction, and its position along it.

    Its unknowns are `position`, along the axis at rest from the clamp [m], and `force_y` and `force_z`, along the axes
    of the cross-section there [N]: a force on the face at +y has a negative `force_y`. It neither
    twists the finger nor pushes along it, as a force on an edge or a corner does.

    Args:
        rod: the finger.
        noise: of the measurements.
        most: largest component of the force [N]; by default that of the trained states on the tip plate.
    """

    def __init__(self, rod: Rod, noise: Noise, most: float | None = None):
        tip = rod.struct.segments[rod.struct.plates - 1]
        largest = float(tip.upper[tip.tensions + 1]) if most is None else most
        front = float(rod.rest[0] + rod.half_lengths[0])
        pulled = [[one.lower, one.upper] for one in rod.parameters]
        ranges = np.array([*pulled, [0.0, front], [-largest, largest], [-largest, largest]]).T
        super().__init__(Unknowns(FORCE, rod, ranges), noise, np.array([BEGIN * front, 0.0, 0.0]))
        self.rod, self.noise, self.most = rod, noise, most

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle and copy by the arguments."""
        return type(self), (self.rod, self.noise, self.most)
