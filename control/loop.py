"""A control loop at a rate: reads every finger, steps its controller, and reports the time that each period took."""

import logging
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from control.plant import Plant, age_of
from rom.brief import brief

ROUNDING = 1e-9  # relative difference of equal periods [-]

logger = logging.getLogger(__name__)


class Controller(Protocol):
    """Controller of one finger, which `run` steps: a `Grip`, a `TrackingController`.

    Attributes:
        tensions: current command, shape (tensions,) [N].
        events: period and name of every event.
    """

    tensions: np.ndarray
    events: list[tuple[int, str]]

    @property
    def period(self) -> float:
        """Time between steps [s]."""

    @property
    def status(self) -> str:
        """One word."""

    def step(self, felt: float, age: float = 0.0, tip: ArrayLike | None = None) -> np.ndarray:
        """Return the next tensions [N] after readings of force [N] and tip, shape (3,) [m], of an age [s]."""
        ...


@brief
@dataclass(frozen=True, kw_only=True)
class LoopReport:
    """Record of a loop.

    Attributes:
        rate: [Hz].
        periods: their number.
        p50_us, p99_us, p999_us, max_us: time of the controllers in a period [us].
        missed: periods whose controllers took longer than the period; in real time, that ended late.
        unread: readings that a plant failed to give, by an error of its own.
        events: period, finger and name of every event, see the controllers.
        tensions: pulled, shape (periods, fingers, tensions) [N].
        felt: readings, shape (periods, fingers) [N].
        tips: true tips of simulated plants across the finger, y and z, shape (periods, fingers, 2) [m]; nan of others.
        contact_forces: likewise their true contact forces, shape (periods, fingers) [N].
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
    tips: np.ndarray = field(repr=False)
    contact_forces: np.ndarray = field(repr=False)
    status: list[str]

    def errors(self, path: np.ndarray, finger: int = 0) -> np.ndarray:
        """Distances of a finger's true tip from rows of a path, y and z, after the first row, shape (periods,) [m].

        Raises:
            ValueError: the path has fewer rows than periods + 1.
        """
        if len(path) <= self.periods:
            raise ValueError(f"path must have a row more than the {self.periods} periods, got {len(path)}")
        return np.asarray(np.linalg.norm(self.tips[:, finger] - path[1 : 1 + self.periods], axis=1))

    @property
    def share(self) -> float:
        """Share of the period that 99 % of the periods' controllers keep within [-]."""
        return self.p99_us * 1e-6 * self.rate

    def as_json(self) -> dict[str, Any]:
        """Plain numbers, without the readings."""
        names = ("rate", "periods", "p50_us", "p99_us", "p999_us", "max_us", "missed", "unread", "share", "status")
        return {name: getattr(self, name) for name in names} | {"events": [list(event) for event in self.events]}


def run(
    controllers: Sequence[Controller],
    plants: Sequence[Plant],
    periods: int,
    targets: Callable[[int], Sequence[float] | None] | None = None,
    real_time: bool = False,
) -> LoopReport:
    """Drive plants by their controllers; a plant that raises an error has no reading in that period.

    Args:
        controllers: of the fingers, all of one period.
        plants: one for each controller. One with a `tip` also provides readings of the tip, shape (3,) [m].
        periods: their number; a path has `controller.periods`.
        targets: contact forces of grips [N] from a period on; None while they do not change.
        real_time: whether to wait for the beginning of every period.

    Raises:
        ValueError: no controllers, another number of plants, less than one period, or a plant that moves by another
            period than its controller.
    """
    if not controllers or len(plants) != len(controllers):
        raise ValueError(f"plants must be one for each of {len(controllers)} fingers, got {len(plants)}")
    if not isinstance(periods, int | np.integer) or not periods >= 1:
        raise ValueError(f"periods must be an integer of at least 1, got {periods!r}")
    period, count = controllers[0].period, len(controllers)
    for one in (getattr(plant, "period", period) for plant in plants):
        if abs(one - period) > ROUNDING * period:
            raise ValueError(f"plants must have the controllers' period of {period:g} s, got {one:g} s")
    spent, ages = np.zeros(periods), np.zeros(count)
    pulled, felt = np.zeros((periods, count, len(controllers[0].tensions))), np.full((periods, count), np.nan)
    tips, forces = np.full((periods, count, 2), np.nan), np.full((periods, count), np.nan)
    reported, missed, unread = [0] * count, 0, 0
    events: list[tuple[int, int, str]] = []
    begun = time.perf_counter()
    for k in range(periods):
        readings: list[ArrayLike | None] = [None] * count
        for i, (controller, plant) in enumerate(zip(controllers, plants, strict=True)):
            pulled[k, i] = controller.tensions
            try:
                felt[k, i], ages[i] = plant.pull(controller.tensions.tolist()), age_of(plant)
                readings[i] = getattr(plant, "tip", None)
                tips[k, i] = getattr(plant, "true_tip", np.full(3, np.nan))[1:]
                forces[k, i] = getattr(plant, "contact_force", np.nan)
            except Exception as error:
                level = logging.DEBUG if k and np.isnan(felt[k - 1, i]) else logging.WARNING  # once until the next one
                logger.log(level, "period %d, finger %d: no reading, %s", k, i, error)
                felt[k, i], ages[i], unread = np.nan, 0.0, unread + 1
        started = time.perf_counter()
        wanted = targets(k) if targets else None
        for i, controller in enumerate(controllers):
            if wanted is not None:
                controller.target = wanted[i]  # type: ignore[attr-defined]
            controller.step(float(felt[k, i]), float(ages[i]), readings[i])
        ended = time.perf_counter()
        spent[k] = ended - started
        for i, controller in enumerate(controllers):
            events += [(k, i, event) for _, event in controller.events[reported[i] :]]
            reported[i] = len(controller.events)
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
        tips=tips,
        contact_forces=forces,
        status=[controller.status for controller in controllers],
    )
