"""A finger of another modulus, size and weight by similarity: its outputs and their derivatives, without training.

With E the modulus and a the size, each over the trained one's, tensions F, distances d, and weight per volume g:

    p = a p0(F / (E a^2), d / a, g a / E),   S = a S0(...),   N = E a^2 N0(...),   R = R0(...)

for tip position p, shortenings S, contact force N and rotation R, where p0, S0, N0 and R0 are the model's own.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from control.calibration.guided import along, turn
from rom.answer import FORCE
from rom.brief import brief
from rom.dataset.actuators import refuse_chambers
from rom.rod.rod import Rod
from rom.rod.touched_segment import TouchedSegment

MODULUS, SIZE, DENSITY, FRICTION = range(4)  # columns of the derivatives by similarity
FRICTION_STEP = 2e-3  # of the difference by friction [-]
STEP = 1e-4  # of the central difference by the logarithm of the weight [-]


class Scales(NamedTuple):
    """Modulus, size and density of the rubber, each over the model's, and friction in the guides [-]."""

    modulus: float = 1.0
    size: float = 1.0
    density: float = 1.0
    friction: float = 0.0

    @property
    def force(self) -> float:
        """The scale of forces at equal shape [-]."""
        return self.modulus * self.size**2


@brief
class Outputs(NamedTuple):
    """Outputs of a finger with t tendons in n states.

    The rows of the derivatives are position, 3 [m]; turn of the tip plate about its own axes, 3 [rad]; shortenings,
    t [m]; contact force [N]. The columns of the second are the logarithms of modulus, size and density,
    and friction.

    Attributes:
        position: of the tip plate's centre, shape (n, 3) [m].
        orientation: of its frame, quaternions w, x, y, z, shape (n, 4) [-].
        shortening: shape (n, t) [m].
        contact_force: shape (n,) [N].
        by_tension: shape (n, 7 + t, t) [per N].
        by_scales: shape (n, 7 + t, 4) [per 1].
        inside: whether the states lie where the model was trained, shape (n,).
    """

    position: np.ndarray
    orientation: np.ndarray
    shortening: np.ndarray
    contact_force: np.ndarray
    by_tension: np.ndarray
    by_scales: np.ndarray
    inside: np.ndarray


class ScaledFinger:
    """A finger before its plane, at any modulus, size and density.

    Args:
        model: the finger. Its plane's distance d is from the finger's surface at rest, at any size.
        weight: whether the density changes: the derivative by it takes two more evaluations.
        guides: whether tendons rub in their guides: the states are a history, see `control.calibration.guided`.
    """

    def __init__(self, model: TouchedSegment, weight: bool = False, guides: bool = False):
        refuse_chambers(model.scene, "a log to calibrate on")
        self.model, self.weight, self.guides = model, weight, guides

    def at(self, scales: Scales, tensions: np.ndarray, distances: np.ndarray) -> Outputs:
        """Outputs at tensions, shape (n, t) [N], and distances, shape (n,) [m], infinite without contact."""
        size, force = scales.size, scales.force
        points = np.column_stack([tensions / force, distances / size])
        pull = self._weighing(scales)
        values, orientation, jacobians, inside = _evaluated(pull, points)
        by_friction = np.zeros_like(values)
        if self.guides:
            values, orientation, by_own, inside = along(pull, points, scales.friction)
            jacobians[..., :-1] = by_own
            by_friction = _by_friction(pull, points, scales.friction)
        t = tensions.shape[1]
        rows = np.concatenate([np.full(3, size), np.ones(3), np.full(t, size), [force]])
        by_input = rows[:, None] * jacobians
        by_tension, by_distance = by_input[..., :t] / force, by_input[..., t]
        reach = np.where(np.isfinite(points[:, t]), points[:, t], 0.0)
        by_force = np.einsum("nij,nj->ni", by_input[..., :t], points[:, :t])
        by_pull = self._by_weight(scales, points) * rows
        scaled = values * rows
        lengths, forces = (np.isin(np.arange(7 + t), those) for those in ([0, 1, 2, *range(6, 6 + t)], [6 + t]))
        by_scales = np.empty((*scaled.shape, 4))
        by_scales[..., FRICTION] = by_friction * rows
        by_scales[..., MODULUS] = scaled * forces - by_force - by_pull
        by_scales[..., SIZE] = scaled * (lengths + 2.0 * forces) - 2 * by_force - by_distance * reach[:, None] + by_pull
        by_scales[..., DENSITY] = self._by_density(scales, points) * rows
        return Outputs(
            scaled[:, :3], orientation, scaled[:, 6 : 6 + t], scaled[:, 6 + t], by_tension, by_scales, inside
        )

    def _weighing(self, scales: Scales, acceleration: float = 1.0) -> TouchedSegment:
        """The model, whose weight is that of the scaled finger divided by its modulus and multiplied by its size."""
        rod = self.model.rod
        if "gravity" not in rod.scene:
            return self.model
        factor = acceleration * scales.size / scales.modulus
        return replace(self.model, rod=weighing(rod, scales.density, factor))

    def _by_weight(self, scales: Scales, points: np.ndarray) -> np.ndarray:
        """Derivatives of the model's own values by the logarithm of the acceleration, by a central difference."""
        if "gravity" not in self.model.rod.scene:
            return np.zeros((len(points), 7 + points.shape[1] - 1))
        return _difference(*(_evaluated(self._weighing(scales, 1 + s), points)[:2] for s in (STEP, -STEP)))

    def _by_density(self, scales: Scales, points: np.ndarray) -> np.ndarray:
        """Likewise by the logarithm of the rubber's density."""
        if not self.weight:
            return np.zeros((len(points), 7 + points.shape[1] - 1))
        others = (scales._replace(density=scales.density * (1 + s)) for s in (STEP, -STEP))
        return _difference(*(_evaluated(self._weighing(one), points)[:2] for one in others))


def weighing(rod: Rod, density: float, acceleration: float) -> Rod:
    """The same finger with its rubber's density and the acceleration multiplied by factors [-]."""
    table = rod.scene["gravity"]
    heavier = rod.with_gravity(table["direction"], float(table["acceleration"] * acceleration))
    heavier.scene["gravity"]["density"] = float(table["density"] * density)
    return heavier


def _evaluated(model: TouchedSegment, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Values, shape (n, 7 + t), with 0 for the turn; orientations; derivatives by inputs; whether all is inside."""
    answers, report = model.answers(points), model.report(points)
    turns = np.zeros((len(points), 3))
    values = np.column_stack(
        [answers.out[:, :FORCE] + model.rod.rest, turns, report.shortenings, answers.out[:, FORCE]]
    )
    turn = 2 * _left(report.orientation)[:, 1:] @ report.orientation_jacobian
    jacobians = [answers.jacobians[:, :FORCE], turn, report.shortening_jacobian, answers.jacobians[:, FORCE, None]]
    return values, report.orientation, np.concatenate(jacobians, axis=1), answers.inside & report.inside


def _by_friction(model: TouchedSegment, points: np.ndarray, friction: float) -> np.ndarray:
    """Derivatives of the values by the friction, by a difference that is central where the friction allows it."""
    ends = max(friction - FRICTION_STEP, 0.0), max(friction, 0.0) + FRICTION_STEP
    behind, ahead = (along(model, points, one, derivatives=False) for one in ends)
    difference = (ahead.values - behind.values) / (ends[1] - ends[0])
    difference[:, 3:6] = turn(behind.orientation, ahead.orientation) / (ends[1] - ends[0])
    return difference


def _left(quaternions: np.ndarray) -> np.ndarray:
    """Matrices, shape (n, 4, 4), that multiply by the conjugates of quaternions from the left."""
    w, x, y, z = quaternions.T
    return np.moveaxis(np.array([[w, x, y, z], [-x, w, z, -y], [-y, -z, w, x], [-z, y, -x, w]]), 2, 0)


def _difference(ahead: tuple[np.ndarray, np.ndarray], behind: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """Central differences of values; of orientations as turns about the plate's axes."""
    difference = (ahead[0] - behind[0]) / (2 * STEP)
    difference[:, 3:6] = turn(behind[1], ahead[1]) / (2 * STEP)
    return difference
