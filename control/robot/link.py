"""A controller's end of a UDP connection to motors: a command and the newest reading in every period."""

from __future__ import annotations

import socket
import time
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from control.robot.messages import MODES, STOP, Command, Reading, packed_command, reading_of
from rom.brief import brief

LARGEST = 2048  # bytes of a datagram that are read; all of ours are shorter


@brief
class Sample(NamedTuple):
    """The reading of a period.

    Attributes:
        reading: the newest so far; None if none has come.
        status: "fresh" if it answers this period's command, "late" if an earlier one; "held" if none came, and the
            reading is an earlier one; "stopped" after too many of these.
        age: periods since the command that the reading answers.
    """

    reading: Reading | None
    status: str
    age: int


@dataclass
class Counts:
    """Numbers of datagrams and periods.

    Attributes:
        late: readings that answered an earlier command.
        overtaken: readings that came after a newer one, or twice.
        refused: datagrams that were no readings.
        missing: periods without a reading.
    """

    late: int = 0
    overtaken: int = 0
    refused: int = 0
    missing: int = 0


class Link:
    """Commands to motors and readings from them. One instance has one socket; `close` it, or use it in a `with`.

    After `patience` periods in a row without a new reading it stops: the motors get the command to stop, in every
    further period too, until `restart`.

    Attributes:
        counts: numbers of datagrams and periods so far.
        stopped: whether it has stopped.

    Args:
        address: host and port of the motors.
        tendons: their number.
        patience: periods without a reading before it stops.
        local: host and port of this end; port 0 takes a free one.

    Raises:
        ValueError: patience below 1.
    """

    def __init__(
        self, address: tuple[str, int], tendons: int, patience: int = 20, local: tuple[str, int] = ("127.0.0.1", 0)
    ):
        if patience < 1:
            raise ValueError(f"patience must be at least 1 period, got {patience}")
        self.counts, self.stopped = Counts(), False
        self._tendons, self._patience = tendons, patience
        self._number, self._in_a_row = 0, 0
        self._newest: Reading | None = None
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(local)
        self._socket.connect(address)

    def __enter__(self) -> Link:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Stop the motors and close the socket."""
        self._send(STOP, np.zeros(self._tendons))
        self._socket.close()

    def restart(self) -> None:
        """Go on after a stop; the last reading is forgotten."""
        self.stopped, self._in_a_row, self._newest = False, 0, None

    def send(self, values: ArrayLike, mode: str = "tension") -> None:
        """Command tensions [N] or, in mode "position", shortenings [m], shape (t,); a stop if it has stopped.

        Raises:
            ValueError: another mode, or values that are not finite or of the wrong shape.
        """
        asked = np.asarray(values, float)
        if mode not in MODES:
            raise ValueError(f"mode must be one of {', '.join(MODES)}, got {mode}")
        if asked.shape != (self._tendons,) or not np.isfinite(asked).all():
            raise ValueError(f"values must be {self._tendons} finite numbers, got {asked.tolist()}")
        self._number += 1
        self._send(STOP if self.stopped else MODES[mode], asked)

    def receive(self, wait: float = 0.0) -> Sample:
        """The newest reading, for which it waits at most `wait` [s] until one answers the last command."""
        before = self._newest.number if self._newest else 0
        deadline = time.monotonic() + wait
        self._take(0.0)
        while (self._newest is None or self._newest.number < self._number) and time.monotonic() < deadline:
            self._take(deadline - time.monotonic())
        number = self._newest.number if self._newest else 0
        came = number > before
        self._in_a_row = 0 if came else self._in_a_row + 1
        self.counts.missing += not came
        self.counts.late += came and number < self._number
        self.stopped |= self._in_a_row >= self._patience
        status = "fresh" if came else "held"
        if came and number < self._number:
            status = "late"
        if self.stopped:
            status = "stopped"
        return Sample(self._newest, status, self._number - number)

    def _send(self, mode: int, values: np.ndarray) -> None:
        try:
            self._socket.send(packed_command(Command(self._number, mode, values)))
        except ConnectionError:  # nobody listens: a reading will be missing
            return

    def _take(self, wait: float) -> None:
        """Read all datagrams that are there; wait for the first one."""
        while True:
            self._socket.settimeout(max(wait, 0.0))
            try:
                datagram = self._socket.recv(LARGEST)
            except (BlockingIOError, TimeoutError, ConnectionError):
                return
            wait = 0.0
            reading = reading_of(datagram, self._tendons)
            if reading is None or reading.number > self._number:
                self.counts.refused += 1
            elif self._newest is not None and reading.number <= self._newest.number:
                self.counts.overtaken += 1
            else:
                self._newest = reading
