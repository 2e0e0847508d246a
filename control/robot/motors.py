"""Simulated motors of a finger that answer over UDP; replies may be lost or late, as on a network."""

import socket
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

import numpy as np

from control.least_squares import minimise
from control.robot.messages import POSITION, STOP, Command, Reading, command_of, packed_reading
from rom.brief import brief
from rom.rod.touched_segment import TouchedSegment


@brief
@dataclass(frozen=True, kw_only=True)
class Losses:
    """Losses and delays of replies on a network, by the number of the command.

    Attributes:
        lost: commands whose replies are lost.
        late: by how many commands a reply is late.
    """

    lost: Collection[int] = ()
    late: Mapping[int, int] = field(default_factory=dict)


class SimulatedMotors:
    """Motors that pull a simulated finger before an object, and measure without noise by default.

    In position mode they pull every tendon in by its shortening; a tendon that would have to push is slack. When they
    are stopped, or no command has come for `patience` calls of `serve`, they hold the shortenings that they have.

    Attributes:
        address: host and port.
        contact_force: the true one [N].
        holding: whether they hold.

    Args:
        model: of the finger and its object.
        distance: of the object [m].
        shortening_noise: standard deviation of measured shortenings [m].
        tension_noise: of measured tensions [N].
        losses: of replies.
        patience: calls of `serve` without a command before they hold.
        sensor: whether readings have the contact force.
        seed: of the noise.
    """

    def __init__(
        self,
        model: TouchedSegment,
        distance: float,
        *,
        shortening_noise: float = 0.0,
        tension_noise: float = 0.0,
        losses: Losses | None = None,
        patience: int = 20,
        sensor: bool = True,
        seed: int = 0,
    ):
        self._model, self._distance = model, distance
        self._noise, self._random = (tension_noise, shortening_noise), np.random.default_rng(seed)
        self._losses, self._patience, self._sensor = losses or Losses(), patience, sensor
        self._lower, self._upper = (ends[:-1] for ends in model.limits)
        self._tensions = self._lower.copy()
        self._answered()
        self._waiting: list[tuple[int, bytes]] = []
        self._idle, self.holding = 0, False
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self.address: tuple[str, int] = self._socket.getsockname()

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()

    def serve(self, wait: float = 0.0) -> int:
        """Obey and answer all waiting commands; wait at most `wait` [s] for the first. Returns their number."""
        count = 0
        while True:
            self._socket.settimeout(wait if not count else 0.0)
            try:
                datagram, sender = self._socket.recvfrom(2048)
            except OSError:  # none is there
                break
            command = command_of(datagram, len(self._lower))
            if command is not None:
                count += 1
                self._obey(command)
                self._reply(command.number, sender)
        self._idle = 0 if count else self._idle + 1
        self.holding |= self._idle >= self._patience
        return count

    def _obey(self, command: Command) -> None:
        """Pull, and let the finger come to rest."""
        self.holding = command.mode == STOP
        if self.holding:
            return
        if command.mode == POSITION:
            self._tensions = self._at(command.values)
        else:
            self._tensions = np.clip(command.values, self._lower, self._upper)
        self._answered()

    def _answered(self) -> None:
        answer = self._model.evaluate([*self._tensions, self._distance])
        assert answer.shortenings is not None
        self.contact_force, self._shortenings = float(answer.contact_force), answer.shortenings

    def _at(self, shortenings: np.ndarray) -> np.ndarray:
        """Tensions that pull tendons in so far, shape (t,) [N]."""

        def residual(tensions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            report = self._model.report([*tensions, self._distance])
            return report.shortenings - shortenings, report.shortening_jacobian[:, : len(tensions)]

        return minimise(residual, self._tensions, (self._lower, self._upper)).x

    def _reply(self, number: int, sender: tuple[str, int]) -> None:
        """Measure, and send this reply and those that are due, unless the network loses it."""
        tension, shortening = self._noise
        reading = Reading(
            number,
            self._tensions + tension * self._random.standard_normal(len(self._tensions)),
            self._shortenings + shortening * self._random.standard_normal(len(self._tensions)),
            self.contact_force if self._sensor else float("nan"),
        )
        if number not in self._losses.lost:
            self._waiting.append((number + self._losses.late.get(number, 0), packed_reading(reading)))
        due = [datagram for at, datagram in self._waiting if at <= number]
        self._waiting = [one for one in self._waiting if one[0] > number]
        for datagram in due:
            self._socket.sendto(datagram, sender)
