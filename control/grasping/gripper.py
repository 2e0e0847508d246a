"""A gripper: fingers evenly around an axis that feel, find and hold an object of unknown position."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from control.finger import Finger
from control.grasping.grasp_controller import Grip, Pull
from control.grasping.grasp_forces import Object, Targets, targets
from control.grasping.grasp_options import GraspOptions
from control.model import Model
from control.motion import Limits
from control.plant import Plant, age_of
from rom.answer import FORCE
from rom.brief import brief

FIRST = 0.3  # of a contact force that the first touch may have, readings in doubt and late included
SQUEEZE = 0.06  # [s] from touch to the held force
STEEP = 1000  # points at which it looks how steeply contact force grows with tension


@brief
@dataclass(frozen=True, kw_only=True)
class Grasp:
    """Result of a grasp.

    Attributes:
        status: of every finger: converged, or why not (see control.grasping.grasp_controller; iteration_limit after
            too many pulls).
        reason: why a finger does not hold, in a sentence; empty if it does. One of each.
        tensions: of every finger, shape (fingers, tensions) [N].
        contact_forces: last felt, shape (fingers,) [N].
        distances: d* of every finger, shape (fingers,) [m]; nan without contact.
        centre: of the object in the gripper's plane, shape (2,) [m], by the fingers that hold; nan if fewer than three.
        radius: from the centre to its faces [m]; likewise.
        history: every pull in order.
    """

    status: list[str]
    reason: list[str]
    tensions: np.ndarray
    contact_forces: np.ndarray
    distances: np.ndarray
    centre: np.ndarray
    radius: float
    history: list[Pull] = field(repr=False)

    @property
    def converged(self) -> bool:
        """True if every finger holds."""
        return all(status == "converged" for status in self.status)

    def as_json(self) -> dict[str, Any]:
        """Plain numbers, without the history."""
        return {
            "status": self.status,
            "reason": self.reason,
            "tensions": self.tensions.tolist(),
            "contact_forces": self.contact_forces.tolist(),
            "distances": self.distances.tolist(),
            "centre": self.centre.tolist(),
            "radius": self.radius,
            "pulls": len(self.history),
        }


def evenly_around(fingers: int) -> np.ndarray:
    """Return the directions from the axis to fingers evenly around it, shape (fingers, 2) [-]."""
    angles = 2 * np.pi * np.arange(fingers) / fingers
    return np.column_stack([np.cos(angles), np.sin(angles)])


class Gripper:
    """Fingers evenly around an axis, each bending towards it.

    Finger i stands at angle 360 i / n degrees; its surface at rest is `radius` from the axis. A face of the object
    across the i-th direction e_i, at distance r from the object's centre c, is then d_i = radius - c . e_i - r from
    finger i.

    Args:
        model: that of every finger.
        fingers: how many.
        radius: of the circle of fingers [m].
        limits: of every finger's tensions and of their rate.
    """

    def __init__(self, model: Model, fingers: int = 3, radius: float = 0.025, limits: Limits | None = None):
        if fingers < 1:
            raise ValueError(f"fingers must be at least 1, got {fingers}")
        if not model.has_obstacle:
            raise ValueError("model must have an obstacle to grasp, got a scene without one")
        self.model, self.radius = model, radius
        self.fingers = [Finger(model, limits)] * fingers  # one model, one place in memory
        self.directions = evenly_around(fingers)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled and copied by its parameters."""
        return type(self), (self.model, len(self.fingers), self.radius, self.fingers[0].limits)

    def distances(self, centre: Sequence[float], radius: float) -> np.ndarray:
        """Distances of an object's faces from the fingers, shape (fingers,) [m]."""
        return self.radius - self.directions @ np.asarray(centre, float) - radius

    def grips(self, contact_forces: float | ArrayLike, options: GraspOptions | None = None) -> list[Grip]:
        """Controllers of the fingers, open, for a contact force of all or of each, shape (fingers,) [N].

        Raises:
            ValueError: contact forces that are not above 0, or not one for each finger.
        """
        wanted = np.asarray(contact_forces, float)
        if wanted.shape not in ((), (len(self.fingers),)):
            raise ValueError(
                f"contact_force must be one, or {len(self.fingers)} of the fingers, got shape {wanted.shape}"
            )
        if not np.all((wanted > 0) & (wanted < np.inf)):
            raise ValueError(f"contact_force must be above 0 N, got {wanted.tolist()}")
        forces, options = np.broadcast_to(wanted, len(self.fingers)), options or GraspOptions()
        return [Grip(finger, float(force), options) for finger, force in zip(self.fingers, forces, strict=True)]

    def targets(self, held: Object, distances: ArrayLike | None = None, margin: float = 0.1) -> Targets:
        """Contact forces that neither drop nor crush an object, or why there are none.

        Args:
            held: the object.
            distances: of its faces from the fingers, if they are given, shape (fingers,) [m]: only forces that the
                fingers can press there.
            margin: that forces may be off [-].
        """
        found = targets(self.directions, held, margin)
        if distances is None or not found.exist:
            return found
        for i, (finger, force) in enumerate(zip(self.fingers, found.contact_forces, strict=True)):
            motion = finger.hold(float(force), float(np.asarray(distances, float)[i]))
            if not motion.converged:
                why = f"finger {i} cannot press {force:.3g} N on a plane at {motion.distance:.3g} m ({motion.status})"
                why += f": {motion.reason}"
                return replace(found, contact_forces=np.full(len(self.fingers), np.nan), reason=why)
        return found

    def options(
        self, contact_force: float, noise: float = 0.0, delay: int = 0, period: float = 1e-3, tolerance: float = 0.03
    ) -> GraspOptions:
        """Options of a loop at a rate: it closes so slowly that the first touch is felt in time.

        Args:
            contact_force: least to be held [N].
            noise: standard deviation of the force sensors [N].
            delay: periods by which readings are late.
            period: [s].
            tolerance: of held forces [-].
        """
        if not (delay >= 0 and 0 < period < np.inf):
            raise ValueError(f"delay must be at least 0 and period above 0 s, got {delay} and {period}")
        random = np.random.default_rng(0).random((STEEP, len(self.model.parameters)))
        lower, upper = self.model.limits
        slopes = [self.model.jacobian(point)[FORCE, self.model.lead] for point in lower + random * (upper - lower)]
        steep = max(*slopes, 1e-6)
        return GraspOptions(
            noise=noise,
            approach_step=FIRST * contact_force / (steep * (delay + 3)),
            squeeze_steps=round(SQUEEZE / period) + 1,
            tolerance=tolerance,
            period=period,
            patience=20 + 2 * delay,
        )

    def grasp(
        self, contact_force: float | ArrayLike, plants: Sequence[Plant], options: GraspOptions | None = None
    ) -> Grasp:
        """Close until every finger feels the object, find it, squeeze to the contact force and hold.

        Args:
            contact_force: of every finger, or of each, shape (fingers,) [N].
            plants: what each finger drives.
            options: how.

        Raises:
            ValueError: a contact force that is not above 0, or plants that are not one for each finger.
        """
        options = options or GraspOptions()
        grips = self.grips(contact_force, options)
        if len(plants) != len(grips):
            raise ValueError(f"plants must be one for each of the {len(grips)} fingers, got {len(plants)}")
        history: list[Pull] = []
        late = f"the target must be held after at most {options.pulls} pulls, it was not"
        for time in range(options.pulls):
            closing = [i for i, grip in enumerate(grips) if not grip.done]
            if not closing:
                break
            for i in closing:
                grip, tensions, stage = grips[i], grips[i].tensions, grips[i].stage
                felt = plants[i].pull(tensions.tolist())
                grip.step(felt, age_of(plants[i]))
                history.append(
                    Pull(
                        finger=i,
                        time=time,
                        stage=stage,
                        tensions=tensions.tolist(),
                        contact_force=felt,
                        distance=None if np.isnan(grip.distance) else grip.distance,
                    )
                )
        distances = np.array([grip.distance for grip in grips])
        holding = np.array([grip.status == "converged" for grip in grips])
        centre, radius = self.locate(np.where(holding, distances, np.nan))
        return Grasp(
            status=["iteration_limit" if grip.status == "moving" else grip.status for grip in grips],
            reason=[grip.reason or (late if grip.status == "moving" else "") for grip in grips],
            tensions=np.array([grip.tensions for grip in grips]),
            contact_forces=np.array([grip.felt for grip in grips]),
            distances=distances,
            centre=centre,
            radius=radius,
            history=history,
        )

    def locate(self, distances: np.ndarray) -> tuple[np.ndarray, float]:
        """Centre of an object, shape (2,) [m], and its radius [m], that fit distances of its faces best.

        Args:
            distances: from the fingers, shape (fingers,) [m], nan where a finger has no contact.

        Returns:
            nan with fewer than three distances.
        """
        located = np.isfinite(distances)
        if located.sum() < 3:
            return np.full(2, np.nan), float("nan")
        system = np.column_stack([self.directions[located], np.ones(located.sum())])
        *centre, radius = np.linalg.lstsq(system, self.radius - distances[located], rcond=None)[0]
        return np.array(centre), float(radius)
