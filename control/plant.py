"""Plants of controllers: fingers whose tendons are pulled and whose contact force is read, and their faults."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from control.model import Model
from rom.rod.motion.motion_state import MotionState
from rom.rod.motion.moving_finger import MovingFinger
from rom.rod.touched_rod import TouchedRod


class Plant(Protocol):
    """A finger, real or simulated. One whose readings come late also has an `age`: that of the last reading [s]."""

    def pull(self, tensions: ArrayLike) -> float:
        """Set the tensions [N], shape (tensions,), let the finger come to rest, return the contact force felt [N]."""
        ...


def age_of(plant: Plant) -> float:
    """Age of a plant's last reading [s]; 0 if it does not say."""
    return float(getattr(plant, "age", 0.0))


@dataclass(frozen=True, kw_only=True)
class Flaws:
    """Deviations of a simulated finger from its model.

    Attributes:
        noise: standard deviation of the force sensor [N].
        resolution: what it rounds to [N]; 0 does not.
        delay: pulls by which its readings are late.
        period: from pull to pull [s], from which their age follows.
        force_error: share by which the contact force is larger than the model's [-].
        tip_noise: standard deviation of each coordinate of the tip's readings [m].
        friction: coefficient of the tendons in their guides, see `rom.MovingFinger` [-]; of a finger with mass.
    """

    noise: float = 0.0
    resolution: float = 0.0
    delay: int = 0
    period: float = 1e-3
    force_error: float = 0.0
    tip_noise: float = 0.0
    friction: float = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.delay, int | np.integer) or self.delay < 0:
            raise ValueError(f"delay must be an integer of at least 0 pulls, got {self.delay}")
        for name in ("noise", "resolution", "tip_noise", "friction"):
            if not 0 <= getattr(self, name) < np.inf:
                raise ValueError(f"{name} must be finite and at least 0, got {getattr(self, name)}")

    def without_friction(self) -> Flaws:
        """Return these flaws.

        Raises:
            ValueError: they have friction.
        """
        if self.friction > 0:
            raise ValueError(f"flaws.friction must be 0 except in a MovingPlant, got {self.friction}")
        return self


class Sensor:
    """A force sensor with flaws; if it reads tips, also a sensor of the tip.

    Attributes:
        age: of the last reading [s].
        tip: the last reading of it, shape (3,) [m].

    Args:
        flaws: its own.
        seed: of the noise.
    """

    def __init__(self, flaws: Flaws, seed: int = 0):
        self.age, self.tip = 0.0, np.full(3, np.nan)
        self._flaws, self._random = flaws, np.random.default_rng(seed)
        self._past: list[tuple[float, np.ndarray | None]] = []

    def read(self, contact_force: float, tip: np.ndarray | None = None) -> float:
        """Return the reading of a contact force [N]; `tip` is then that of the tip, shape (3,) [m]."""
        flaws, now = self._flaws, (contact_force, tip)
        self._past = [*self._past[-flaws.delay :], now] if flaws.delay else [now]
        self.age = flaws.period * (len(self._past) - 1)
        then, place = self._past[0]
        felt = then + flaws.noise * float(self._random.standard_normal())
        if place is not None:
            self.tip = place + flaws.tip_noise * self._random.standard_normal(3)
        return felt if flaws.resolution == 0 else flaws.resolution * round(felt / flaws.resolution)


class SimulatedPlant:
    """A finger simulated by a model, in front of a plane whose distance the controller does not have.

    Attributes:
        contact_force: the true one, after the last pull [N].
        age: of the last reading [s].

    Args:
        model: of the finger.
        distance: of the plane [m].
        flaws: without friction; none if left out.
        seed: of the noise.

    Raises:
        ValueError: flaws with friction.
    """

    def __init__(self, model: Model, distance: float, flaws: Flaws | None = None, seed: int = 0):
        self.contact_force, self.age = 0.0, 0.0
        self._model, self._distance, self._flaws = model, distance, (flaws or Flaws()).without_friction()
        self._sensor = Sensor(self._flaws, seed)

    def pull(self, tensions: ArrayLike) -> float:
        """See Plant.

        Raises:
            ValueError: tensions or plane outside the trained box: the model cannot play such a finger.
        """
        point = np.append(np.asarray(tensions, float), self._distance)
        answer = self._model.evaluate(point)
        if not answer.inside:
            lower, upper = (end.tolist() for end in self._model.limits)
            raise ValueError(
                f"tensions and d must lie in the trained box, {lower} to {upper}, and nothing but the plate may touch, "
                f"got {point.tolist()}"
            )
        self.contact_force = (1 + self._flaws.force_error) * float(answer.contact_force)
        felt, self.age = self._sensor.read(self.contact_force), self._sensor.age
        return felt


class MovingPlant:
    """A finger pulled by tensions that change linearly in a period; it has mass, and does not come to rest between.

    Attributes:
        state: after the last pull; None before the first.
        contact_force: the true one, its mean over the last pull's period [N]: at impact on a rigid object, the force
            at an instant depends on the step of time, and the mean does not.
        age: of the last readings [s].

    Args:
        model: of the finger before one object.
        distance: of the object [m].
        density: of the rubber [kg/m^3]; that of the scene's [gravity] if left out.
        flaws: none if left out; their period is that from pull to pull [s].
        seed: of the noise.
        steps: of time in a period.
        tensions: by which it rests before the first pull, shape (t,) [N]; none if left out. With friction, motors have
            reached them from rest.

    Raises:
        ModelError: no density, or the object touches the finger that rests.
    """

    def __init__(
        self,
        model: TouchedRod,
        distance: float,
        density: float | None = None,
        flaws: Flaws | None = None,
        seed: int = 0,
        steps: int = 1,
        tensions: ArrayLike | None = None,
    ):
        if not isinstance(steps, int) or steps < 1:
            raise ValueError(f"steps must be an integer of at least 1, got {steps}")
        self.state: MotionState | None = None
        self.contact_force, self.age = 0.0, 0.0
        self._distance, self._steps, self._flaws = distance, steps, flaws or Flaws()
        self._sensor, self._rest = Sensor(self._flaws, seed), model.rod.rest
        rest = np.append(np.zeros(len(model.rod.names)) if tensions is None else np.asarray(tensions, float), distance)
        self._finger = MovingFinger(model, rest, density, friction=self._flaws.friction or None)
        self._tensions = rest[:-1]

    @property
    def period(self) -> float:
        """Time from pull to pull [s]."""
        return self._flaws.period

    @property
    def tip(self) -> np.ndarray:
        """Reading of the tip plate's centre in the clamp's frame, of the same age, shape (3,) [m]; nan before one."""
        return self._sensor.tip

    @property
    def true_tip(self) -> np.ndarray:
        """The tip plate's centre in the clamp's frame after the last pull, shape (3,) [m]; nan before one."""
        return np.full(3, np.nan) if self.state is None else self._rest + self.state.tip

    def pull(self, tensions: ArrayLike) -> float:
        """See Plant.

        Raises:
            ValueError: the finger moves out of the domain of its elements, or no step was found.
        """
        goal, begun, length = np.asarray(tensions, float), self._tensions, self._flaws.period / self._steps
        forces = []
        for k in range(1, self._steps + 1):
            now = goal if k == self._steps else begun + k / self._steps * (goal - begun)
            self.state = self._finger.step(np.append(now, self._distance), length)
            if self.state.status != "converged":
                raise ValueError(
                    f"tensions must keep the finger where its elements were trained, got {self.state.status} at "
                    f"{goal.tolist()}, {self.state.time:.4g} s"
                )
            forces.append(float(self.state.contact_forces[0]))
        self._tensions, self.contact_force = goal, (1 + self._flaws.force_error) * float(np.mean(forces))
        felt, self.age = self._sensor.read(self.contact_force, self.true_tip), self._sensor.age
        return felt


class Slipping:
    """A finger one of whose tendons slips in its clamp: from a pull on, only a share of its tension arrives."""

    def __init__(self, plant: Plant, tendon: int, share: float, begin: int):
        self._plant, self._tendon, self._share, self._begin, self._pulls = plant, tendon, share, begin, 0

    @property
    def age(self) -> float:
        """Age of the last reading [s]."""
        return age_of(self._plant)

    def pull(self, tensions: ArrayLike) -> float:
        """See Plant."""
        arriving = np.array(tensions, float)
        if self._pulls >= self._begin:
            arriving[self._tendon] *= self._share
        self._pulls += 1
        return self._plant.pull(arriving)


class Dead:
    """A finger whose sensor reads NaN during some pulls."""

    def __init__(self, plant: Plant, begin: int, end: float = np.inf):
        self._plant, self._begin, self._end, self._pulls = plant, begin, end, 0

    @property
    def age(self) -> float:
        """Age of the last reading [s]."""
        return age_of(self._plant)

    def pull(self, tensions: ArrayLike) -> float:
        """See Plant."""
        felt, self._pulls = self._plant.pull(tensions), self._pulls + 1
        return float("nan") if self._begin < self._pulls <= self._end else felt
