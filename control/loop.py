"""A control loop at a rate: reads every finger, steps its controller, and reports the time that each period took."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from control.grasping.grasp_controller import Grip
from control.plant import Plant, age_of
from rom.brief import brief

logger = logging.getLogger(__name__)


@brief
@dataclass(frozen=True, kw_only=True)
class LoopReport:
    """How a loop ran.

    Attributes:
        rate: [Hz].
        periods: how many.
        p50_us, p99_us, p999_us, max_us: time of the controllers in a period [us].
        missed: periods whose controllers took longer than the period; in real time, that ended late.
        unread: readings that a plant failed to give, by an error of its own.
        events: what happened: period, finger, event (see control.grasping.grasp_controller).
        tensions: pulled, shape (periods, fingers, tensions) [N].
        felt: readings, shape (periods, fingers) [N].
        status: of every finger at the end.
    """

    rate: float
    periods: int
    p50_us: float
    p99_us: float
    p999_us: float
    max_us: float
    missed: int
    unread: int
    events: list[tuple[int, int, str]]
    tensions: np.ndarray = field(repr=False)
    felt: np.ndarray = field(repr=False)
    status: list[str]

    @property
    def share(self) -> float:
        """Share of the period that 99 % of the periods' controllers keep within [-]."""
        return self.p99_us * 1e-6 * self.rate

    def as_json(self) -> dict[str, Any]:
        """Plain numbers, without the readings."""
        names = ("rate", "periods", "p50_us", "p99_us", "p999_us", "max_us", "missed", "unread", "share", "status")
        return {name: getattr(self, name) for name in names} | {"events": [list(event) for event in self.events]}


def run(
    grips: Sequence[Grip],
    plants: Sequence[Plant],
    periods: int,
    targets: Callable[[int], Sequence[float] | None] | None = None,
    real_time: bool = False,
) -> LoopReport:
    """Drive plants by their controllers, whatever happens: a plant that raises has given no reading.

    Args:
        grips: controllers of the fingers, all of one period.
        plants: what each drives.
        periods: how many.
        targets: the fingers' contact forces [N] from a period on, or None while they stay.
        real_time: whether to wait for the beginning of every period.

    Raises:
        ValueError: no fingers, plants that are not one for each, or less than one period.
    """
    if not grips or len(plants) != len(grips):
        raise ValueError(f"plants must be one for each of {len(grips)} fingers, got {len(plants)}")
    if not periods >= 1:
        raise ValueError(f"periods must be at least 1, got {periods}")
    period = grips[0].period
    spent = np.zeros(periods)
    pulled, felt = np.zeros((periods, len(grips), len(grips[0].tensions))), np.zeros((periods, len(grips)))
    reported, missed, unread = [0] * len(grips), 0, 0
    events: list[tuple[int, int, str]] = []
    begun = time.perf_counter()
    for k in range(periods):
        ages = np.zeros(len(grips))
        for i, (grip, plant) in enumerate(zip(grips, plants, strict=True)):
            pulled[k, i] = grip.tensions
            try:
                felt[k, i], ages[i] = plant.pull(grip.tensions.tolist()), age_of(plant)
            except Exception as error:
                logger.warning("period %d, finger %d: no reading, %s", k, i, error)
                felt[k, i], unread = np.nan, unread + 1
        started = time.perf_counter()
        wanted = targets(k) if targets else None
        for i, grip in enumerate(grips):
            if wanted is not None:
                grip.target = wanted[i]
            grip.step(float(felt[k, i]), float(ages[i]))
        ended = time.perf_counter()
        spent[k] = ended - started
        for i, grip in enumerate(grips):
            events += [(k, i, event) for _, event in grip.events[reported[i] :]]
            reported[i] = len(grip.events)
        missed += bool(spent[k] > period or (real_time and ended > begun + (k + 1) * period))
        if real_time:
            time.sleep(max(begun + (k + 1) * period - time.perf_counter(), 0.0))
    quantiles = 1e6 * np.percentile(spent, [50, 99, 99.9, 100])
    return LoopReport(
        rate=1 / period,
        periods=periods,
        p50_us=float(quantiles[0]),
        p99_us=float(quantiles[1]),
        p999_us=float(quantiles[2]),
        max_us=float(quantiles[3]),
        missed=missed,
        unread=unread,
        events=events,
        tensions=pulled,
        felt=felt,
        status=[grip.status for grip in grips],
    )
