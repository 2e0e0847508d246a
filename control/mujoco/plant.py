"""Fingers of a simulation as plants of controllers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from numpy.typing import ArrayLike

from control.mujoco.simulation import Simulation
from control.plant import Flaws, Sensor


class MujocoPlant:
    """One finger of a simulation: a pull advances it by a period.

    Fingers share a period: a pull of the finger k of n advances the simulation to the share (k + 1) / n of the period.

    Attributes:
        contact_force: true one after the last pull [N].
        age: of the last reading [s].

    Args:
        simulation: of the finger.
        finger: index of the finger.
        period: time between pulls [s].
        flaws: of its sensor, which has this period, without friction; by default none.
        seed: of the noise.
    """

    def __init__(
        self, simulation: Simulation, finger: int, period: float = 0.01, flaws: Flaws | None = None, seed: int = 0
    ):
        if not period >= simulation.model.opt.timestep:
            raise ValueError(f"period must be at least a step, {simulation.model.opt.timestep:g} s, got {period:g} s")
        self.contact_force, self.age = 0.0, 0.0
        self._simulation, self._finger, self._period = simulation, finger, period
        self._sensor = Sensor(replace((flaws or Flaws()).without_friction(), period=period), seed)
        self._turn = period * (finger + 1) / len(simulation.fingers)
        self._begun: float | None = None  # of its next period [s]

    def pull(self, tensions: ArrayLike) -> float:
        """See control.plant.Plant.

        Raises:
            ValueError: tensions outside the trained domain.
            SimulationStopped: see `Simulation.step`.
        """
        simulation, period = self._simulation, self._period
        begun = period * int(simulation.time / period + 1e-9)
        if self._begun is None or not -1 <= round((begun - self._begun) / period) <= 0:
            self._begun = begun  # the first pull, or time has gone on or begun anew without this finger
        simulation.pull(self._finger, tensions)
        simulation.advance(self._begun + self._turn)
        self._begun += period
        self.contact_force = float(simulation.contact_forces()[self._finger])
        felt, self.age = self._sensor.read(self.contact_force), self._sensor.age
        return felt


def plants(
    simulation: Simulation, period: float = 0.01, flaws: Sequence[Flaws | None] | Flaws | None = None, seed: int = 0
) -> list[MujocoPlant]:
    """Return plants for all fingers of a simulation, with common or individual flaws."""
    count = len(simulation.fingers)
    each = [flaws] * count if flaws is None or isinstance(flaws, Flaws) else list(flaws)
    return [MujocoPlant(simulation, k, period, one, seed + k) for k, one in enumerate(each)]
