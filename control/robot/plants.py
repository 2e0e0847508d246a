"""Plants for `control.run` whose readings come from a log or over a link."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from control.log import Log
from control.robot.link import Link, Sample
from control.robot.messages import Reading

Felt = Callable[[Reading], float]


def measured_force(reading: Reading) -> float:
    """The contact force of a sensor [N]."""
    return reading.contact_force


class LinkedPlant:
    """A finger whose motors answer over a link, at a rate; see `control.Plant`.

    Attributes:
        age: of the last reading [s].
        sample: the last one.

    Args:
        link: to the motors.
        period: of the loop [s].
        wait: how long it waits for the answer to a command [s].
        felt: contact force [N] of a reading: of the sensor by default; without one, see `control.feel`.
        positions: shortenings [m] for wanted tensions [N], shapes (t,): motors are then driven by position.
    """

    def __init__(
        self,
        link: Link,
        period: float = 1e-3,
        wait: float = 0.0,
        felt: Felt = measured_force,
        positions: Callable[[np.ndarray], np.ndarray] | None = None,
    ):
        self.age, self.sample = 0.0, Sample(None, "held", 0)
        self._link, self._period, self._wait, self._felt, self._positions = link, period, wait, felt, positions

    def pull(self, tensions: ArrayLike) -> float:
        """Command tensions [N], shape (t,), and return the contact force [N]; nan before a reading and after a stop."""
        pulled = np.asarray(tensions, float)
        if self._positions is None:
            self._link.send(pulled)
        else:
            self._link.send(self._positions(pulled), "position")
        self.sample = self._link.receive(self._wait)
        self.age = self._period * self.sample.age
        if self.sample.reading is None or self.sample.status == "stopped":
            return float("nan")
        return self._felt(self.sample.reading)


class ReplayedPlant:
    """The readings of a log, whatever is pulled; see `control.Plant`.

    Period k is at k times the period after the log's first time. Its reading is the last row until then, whose age says
    how late it is. Without a column t every period has the next row.

    Attributes:
        age: of the last reading [s].
        row: of the log.

    Args:
        log: with contact forces, or with tensions and shortenings for `felt`.
        period: of the loop [s].
        felt: contact force [N] of a reading; that of the log by default.

    Raises:
        ValueError: a log that lacks a column that is read.
    """

    def __init__(self, log: Log, period: float = 1e-3, felt: Felt = measured_force):
        needed = ("contact force",) if felt is measured_force else ("tension", "shortening")
        lacking = [name for name in needed if not log.has(name)]
        if lacking:
            raise ValueError(f"{log.path}: must have columns of {' and '.join(needed)}, got no {lacking[0]}")
        n = len(log.lines)
        self._times = log.time - log.time[0] if log.has("t") else period * np.arange(n)
        if np.isnan(self._times).any():
            row = int(np.flatnonzero(np.isnan(self._times))[0])
            raise ValueError(f"{log.where(row, 't')}: must have a time, got an empty cell")
        self.age, self.row = 0.0, -1
        self._log, self._period, self._felt, self._pulls = log, period, felt, 0

    @property
    def periods(self) -> int:
        """The log's length in periods."""
        return int(self._times[-1] / self._period + 1e-9) + 1

    def pull(self, tensions: ArrayLike) -> float:
        """The contact force of the period [N]; nan where the log has none."""
        now, self._pulls = self._period * self._pulls, self._pulls + 1
        self.row = int(np.searchsorted(self._times, now + 1e-9 * self._period, side="right")) - 1
        self.age = float(now - self._times[self.row])
        log = self._log
        return self._felt(
            Reading(self.row, log.tension[self.row], log.shortening[self.row], float(log.contact_force[self.row]))
        )
