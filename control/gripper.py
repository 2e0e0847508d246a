"""A gripper: fingers evenly around an axis that feel, find and hold an object whose place they do not know."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from control.finger import Finger, Motion
from control.plant import Plant
from rom import Surrogate


@dataclass(frozen=True, kw_only=True)
class GraspOptions:
    """How to grasp.

    Attributes:
        feel: a force above this is contact [N].
        approach_step: the lead tension's step while nothing is felt [N].
        squeeze_steps: pulls from touch to the held force.
        tolerance: a held force this near its target needs no correction [-]. Choose it, and `feel`, above three
            standard deviations of the sensor's noise, or corrections chase the noise.
        corrections: most corrections of a finger, new approaches after a touch that was none included.
    """

    feel: float = 0.05
    approach_step: float = 4.0
    squeeze_steps: int = 3
    tolerance: float = 0.005
    corrections: int = 6


@dataclass(frozen=True, kw_only=True)
class Pull:
    """One pull of one finger: its stage (approach, squeeze, hold), tensions [N], force felt [N], d* so far [m]."""

    finger: int
    time: int
    stage: str
    tensions: list[float]
    contact_force: float
    distance: float | None


@dataclass(frozen=True, kw_only=True)
class Grasp:
    """How a grasp ended.

    Attributes:
        status: of every finger: converged, or why not (see Motion; "no_contact" if it felt nothing up to its highest
            tension, "sensor_failed" if what it felt was no number).
        tensions: of every finger, shape (fingers, tensions) [N].
        contact_forces: last felt, shape (fingers,) [N].
        distances: d* of every finger, shape (fingers,) [m]; nan without contact.
        centre: of the object in the gripper's plane, shape (2,) [m], by the fingers that hold; nan if fewer than three.
        radius: from the centre to its faces [m]; likewise.
        history: every pull in order.
    """

    status: list[str]
    tensions: np.ndarray
    contact_forces: np.ndarray
    distances: np.ndarray
    centre: np.ndarray
    radius: float
    history: list[Pull] = field(repr=False)

    @property
    def converged(self) -> bool:
        """Whether every finger holds."""
        return all(status == "converged" for status in self.status)

    def as_json(self) -> dict[str, Any]:
        """Plain numbers, without the history."""
        return {
            "status": self.status,
            "tensions": self.tensions.tolist(),
            "contact_forces": self.contact_forces.tolist(),
            "distances": self.distances.tolist(),
            "centre": self.centre.tolist(),
            "radius": self.radius,
            "pulls": len(self.history),
        }


class Gripper:
    """Fingers evenly around an axis, each bending towards it.

    Finger i stands at angle 360 i / n degrees; its surface at rest is `radius` from the axis. A face of the object
    across the i-th direction e_i, at distance r from the object's centre c, is then d_i = radius - c . e_i - r from
    finger i.

    Args:
        model: the surrogate of every finger.
        fingers: how many.
        radius: of the circle of fingers [m].
    """

    def __init__(self, model: Surrogate, fingers: int = 3, radius: float = 0.025):
        if fingers < 1:
            raise ValueError(f"fingers must be at least 1, got {fingers}")
        if not model.has_obstacle:
            raise ValueError("model must have an obstacle to grasp, got a scene without one")
        self.model, self.radius = model, radius
        self.fingers = [Finger(model) for _ in range(fingers)]
        angles = 2 * np.pi * np.arange(fingers) / fingers
        self.directions = np.column_stack([np.cos(angles), np.sin(angles)])

    def distances(self, centre: Sequence[float], radius: float) -> np.ndarray:
        """Distances of an object's faces from the fingers, shape (fingers,) [m]."""
        return self.radius - self.directions @ np.asarray(centre, float) - radius

    def grasp(self, contact_force: float, plants: Sequence[Plant], options: GraspOptions | None = None) -> Grasp:
        """Close until every finger feels the object, find it, squeeze to the contact force and hold.

        Args:
            contact_force: of every finger [N].
            plants: what each finger drives.
            options: how.

        Raises:
            ValueError: a contact force that is not above 0, or plants that are not one for each finger.
        """
        if not (np.isfinite(contact_force) and contact_force > 0):
            raise ValueError(f"contact_force must be above 0 N, got {contact_force}")
        if len(plants) != len(self.fingers):
            raise ValueError(f"plants must be one for each of the {len(self.fingers)} fingers, got {len(plants)}")
        options = options or GraspOptions()
        closing = [
            _Closing(i, finger, plant, contact_force, options)
            for i, (finger, plant) in enumerate(zip(self.fingers, plants, strict=True))
        ]
        while not all(hand.done for hand in closing):
            for hand in closing:
                if not hand.done:
                    hand.pull()
        distances = np.array([np.nan if hand.distance is None else hand.distance for hand in closing])
        holding = np.array([hand.status == "converged" for hand in closing])
        centre, radius = self._object(np.where(holding, distances, np.nan))
        history = sorted((pull for hand in closing for pull in hand.history), key=lambda pull: (pull.time, pull.finger))
        return Grasp(
            status=[hand.status for hand in closing],
            tensions=np.array([hand.tensions for hand in closing]),
            contact_forces=np.array([hand.felt for hand in closing]),
            distances=distances,
            centre=centre,
            radius=radius,
            history=history,
        )

    def _object(self, distances: np.ndarray) -> tuple[np.ndarray, float]:
        """Centre [m] and radius [m] that explain the distances best."""
        known = np.isfinite(distances)
        if known.sum() < 3:
            return np.full(2, np.nan), float("nan")
        system = np.column_stack([self.directions[known], np.ones(known.sum())])
        *centre, radius = np.linalg.lstsq(system, self.radius - distances[known], rcond=None)[0]
        return np.array(centre), float(radius)


class _Closing:
    """One finger's way from open to holding, a pull at a time."""

    def __init__(self, index: int, finger: Finger, plant: Plant, target: float, options: GraspOptions):
        self._index, self._finger, self._plant, self._target, self._options = index, finger, plant, target, options
        lower, upper = finger.model.limits
        self._lead, self._highest = finger.model.lead, float(upper[finger.model.lead])
        self.tensions = lower[: len(lower) - 1].copy()
        self.felt, self.status, self.done = 0.0, "no_contact", False
        self.distance: float | None = None
        self.history: list[Pull] = []
        self._plan: list[np.ndarray] = []
        self._corrections = 0

    def pull(self) -> None:
        """One more pull: closer while nothing is felt, then along the plan, then corrections."""
        if self.distance is None:
            self._approach()
        elif self._plan:
            stage = "squeeze" if len(self._plan) > 1 else "hold"
            self._feel(self._plan.pop(0), stage)
        elif abs(self.felt - self._target) <= self._options.tolerance * self._target:
            self.status, self.done = "converged", True
        elif self._corrections >= self._options.corrections:
            self.status, self.done = "iteration_limit", True
        elif self.felt <= self._options.feel:  # the touch was noise, or contact was lost: close further
            self._corrections += 1
            self.distance = None
        else:
            self._corrections += 1
            self._decide(squeeze_steps=1)

    def _approach(self) -> None:
        if self.tensions[self._lead] >= self._highest:
            self.done = True
            return
        ahead = self.tensions.copy()
        ahead[self._lead] = min(ahead[self._lead] + self._options.approach_step, self._highest)
        self._feel(ahead, "approach")
        if not self.done and self.felt > self._options.feel:
            self._decide(self._options.squeeze_steps)

    def _decide(self, squeeze_steps: int) -> None:
        """Find the plane from what is felt, and plan the pulls to the target from there."""
        found = self._finger.locate(self.tensions, self.felt)
        if found.status not in ("converged", "unreachable"):
            self.status, self.done = found.status, True
            return
        self.distance = found.distance
        goal: Motion = self._finger.hold(self._target, self.distance, start=self.tensions)
        if not goal.converged:
            self.status, self.done = goal.status, True
            return
        ways = np.linspace(0, 1, squeeze_steps + 1)[1:]
        self._plan = [self.tensions + way * (goal.tensions - self.tensions) for way in ways]

    def _feel(self, tensions: np.ndarray, stage: str) -> None:
        self.felt, self.tensions = self._plant.pull(tensions.tolist()), tensions
        if not np.isfinite(self.felt):
            self.status, self.done = "sensor_failed", True
        self.history.append(
            Pull(
                finger=self._index,
                time=len(self.history),
                stage=stage,
                tensions=tensions.tolist(),
                contact_force=self.felt,
                distance=self.distance,
            )
        )
