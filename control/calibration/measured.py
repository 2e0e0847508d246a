"""Residuals of all columns of a log, a finger's output minus the measurement, and their derivatives.

The tensions of every pose are unknowns, too: all columns are measurements with noise.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from control.calibration.parameters import PLACE, TURN, Unknowns
from control.calibration.scaled_finger import DENSITY, FRICTION, MODULUS, SIZE, Outputs, ScaledFinger, Scales
from control.log import Log
from rom.brief import brief

MOTORS = ("tension", "torque", "shortening", "angle")  # quantities of tendons
RELATIVE = ("tension", "torque", "contact_force")  # their noise is relative
GROUPS = {
    "tension": ("-", 0.02),
    "torque": ("-", 0.02),
    "shortening": ("m", 2e-4),
    "angle": ("rad", 0.02),
    "position": ("m", 5e-4),
    "orientation": ("rad", 0.017),
    "contact_force": ("-", 0.02),
}  # units and first guesses of the standard deviations of noise
SMALL = 0.02  # of the largest value: relative noise is not smaller than that of such a value [-]
BY_SCALE = {"modulus": MODULUS, "size": SIZE, "density": DENSITY, "friction": FRICTION}


@brief
class Residuals(NamedTuple):
    """Residuals of n poses and m columns, without a weight; 0 where nothing was measured.

    Attributes:
        values: model minus measurement, shape (n, m).
        by_tension: shape (n, m, t).
        by_unknown: shape (n, m, p).
        inside: whether the model is within its trained domain, shape (n,).
    """

    values: np.ndarray
    by_tension: np.ndarray
    by_unknown: np.ndarray
    inside: np.ndarray


@brief
@dataclass(frozen=True, kw_only=True)
class Measured:
    """A log before a finger.

    Attributes:
        log: what was measured.
        finger: the model.
        unknowns: what is fitted.
        excluded: measurements that are left out, by group, shape (n,) each.
    """

    log: Log
    finger: ScaledFinger
    unknowns: Unknowns
    excluded: dict[str, np.ndarray] = field(default_factory=dict)

    @cached_property
    def groups(self) -> list[str]:
        """Quantities that were measured."""
        orientation = self.log.has("qw") or self.log.has("rx")
        present = {name: self.log.has(name) for name in MOTORS}
        present |= {"position": any(map(self.log.has, "xyz")), "orientation": orientation}
        return [name for name in GROUPS if present.get(name, self.log.has("contact force"))]

    @cached_property
    def columns(self) -> list[str]:
        """The group of every column, m."""
        t = len(self.log.tendons)
        widths = {"position": 3, "orientation": 3, "contact_force": 1}
        return [name for name in self.groups for _ in range(widths.get(name, t))]

    @cached_property
    def readings(self) -> np.ndarray:
        """Measured values, shape (n, m), nan where there are none; of orientations 0 where there is one."""
        turns = np.where(np.isfinite(self.log.orientation[:, :1]), np.zeros((1, 3)), np.nan)
        of = {name: getattr(self.log, name) for name in (*MOTORS, "position")}
        of |= {"orientation": turns, "contact_force": self.log.contact_force[:, None]}
        return np.hstack([of[name] for name in self.groups])

    @cached_property
    def slack(self) -> np.ndarray:
        """Tendons that do not pull, shape (n, t)."""
        return (self.log.tension == 0) | (self.log.torque == 0)

    @property
    def used(self) -> np.ndarray:
        """Which measurements count, shape (n, m)."""
        counts = np.isfinite(self.readings)
        for k, name in enumerate(self.columns):
            if name in self.excluded:
                counts[:, k] &= ~self.excluded[name]
            if name in RELATIVE:  # without slack tendons, and contact that is hardly any
                least = SMALL if name == "contact_force" else 0.0
                counts[:, k] &= np.abs(self.readings[:, k]) > least * np.nanmax(
                    np.abs(self.readings[:, k]), initial=0.0
                )
        return counts

    @cached_property
    def weights(self) -> np.ndarray:
        """Scales to which the standard deviations of measurements are proportional, shape (n, m)."""
        scales = np.ones_like(self.readings)
        for name in set(self.columns) & set(RELATIVE):
            own = [one == name for one in self.columns]
            sizes = np.abs(np.nan_to_num(self.readings[:, own]))
            scales[:, own] = np.maximum(sizes, SMALL * sizes.max(initial=0.0)) if sizes.any() else 1.0
        return scales

    @cached_property
    def distances(self) -> np.ndarray:
        """D of the object, shape (n,) [m]; infinite where none is measured."""
        return np.where(np.isfinite(self.log.distance), self.log.distance, np.inf)

    def scales(self, unknowns: np.ndarray) -> Scales:
        """Modulus, size and density over the model's, and friction."""
        values, starts = self.unknowns.values(unknowns), self.unknowns.starts
        modulus, size, density = (values[name] / starts[name] for name in ("modulus", "size", "density"))
        return Scales(modulus=modulus, size=size, density=density, friction=values["friction"])

    def ends(self, unknowns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest tensions that the model has, shapes (t,) [N]."""
        t = len(self.log.tendons)
        lower, upper = (one[:t] * self.scales(unknowns).force for one in self.finger.model.limits)
        return lower, upper

    def outputs(self, unknowns: np.ndarray, tensions: np.ndarray) -> Outputs:
        """The finger's outputs at tensions, shape (n, t) [N]."""
        return self.finger.at(self.scales(unknowns), tensions, self.distances)

    def residuals(self, unknowns: np.ndarray, tensions: np.ndarray) -> Residuals:
        """Residuals and derivatives at tensions of all poses, shape (n, t) [N]."""
        outputs, values = self.outputs(unknowns, tensions), self.unknowns.values(unknowns)
        parts = [_ROWS.get(name, _of_tendons)(self, name, outputs, tensions, values) for name in self.groups]
        used = self.used
        rows, by_tension, by_unknown = (np.concatenate(one, axis=1) for one in zip(*parts, strict=True))
        return Residuals(
            np.where(used, rows - np.nan_to_num(self.readings), 0.0),
            np.where(used[..., None], by_tension, 0.0),
            np.where(used[..., None], by_unknown, 0.0),
            outputs.inside,
        )

    def by_scales(self, outputs: Outputs, rows: Sequence[int]) -> np.ndarray:
        """Derivatives of some of the finger's rows by the unknowns, shape (n, rows, p)."""
        slopes = np.zeros((len(outputs.inside), len(rows), len(self.unknowns.names)))
        for name, column in BY_SCALE.items():
            if (k := self.unknowns.index(name)) is not None:
                slopes[..., k] = outputs.by_scales[:, rows, column]
        return slopes


Rows = tuple[np.ndarray, np.ndarray, np.ndarray]  # values (n, rows), and derivatives by tensions and unknowns


def _of_tendons(m: Measured, name: str, outputs: Outputs, tensions: np.ndarray, values: dict[str, float]) -> Rows:
    """Tensions, torques, shortenings or angles of the motors."""
    n, t = tensions.shape
    rows = range(6, 6 + t)
    radius, power = values["pulley_radius"], {"torque": 1, "angle": -1}.get(name, 0)
    if name in ("tension", "torque"):
        of_motors, by_tension = tensions, np.broadcast_to(np.eye(t), (n, t, t))
        by_unknown = np.zeros((n, t, len(m.unknowns.names)))
    else:
        of_motors, by_tension, by_unknown = outputs.shortening, outputs.by_tension[:, rows], m.by_scales(outputs, rows)
    factor = radius**power
    by_unknown = factor * by_unknown
    if power and (k := m.unknowns.index("pulley_radius")) is not None:
        by_unknown[..., k] += power * factor * of_motors
    return factor * of_motors, factor * by_tension, by_unknown


def _position(m: Measured, name: str, outputs: Outputs, tensions: np.ndarray, values: dict[str, float]) -> Rows:
    """Position of the tip plate's centre, seen from the measuring frame: c + R p."""
    rows = range(3)
    vector = np.array([values[name] for name in TURN])
    base = Rotation.from_rotvec(vector).as_matrix()
    position = np.array([values[name] for name in PLACE]) + outputs.position @ base.T
    by_tension, by_unknown = base @ outputs.by_tension[:, rows], base @ m.by_scales(outputs, rows)
    turn = -base @ _cross(outputs.position) @ _turn_by_vector(vector)
    for k, (place, angle) in enumerate(zip(PLACE, TURN, strict=True)):
        if (column := m.unknowns.index(place)) is not None:
            by_unknown[:, k, column] += 1.0
        if (column := m.unknowns.index(angle)) is not None:
            by_unknown[:, :, column] += turn[:, :, k]
    return position, by_tension, by_unknown


def _orientation(m: Measured, name: str, outputs: Outputs, tensions: np.ndarray, values: dict[str, float]) -> Rows:
    """Rotation vector from the measured frame to the model's, about the latter's axes."""
    rows = range(3, 6)
    vector = np.array([values[name] for name in TURN])
    own = Rotation.from_quat(outputs.orientation[:, [1, 2, 3, 0]])
    seen = np.where(np.isfinite(m.log.orientation), m.log.orientation, [1.0, 0.0, 0.0, 0.0])
    relative = Rotation.from_quat(seen[:, [1, 2, 3, 0]]).inv() * Rotation.from_rotvec(vector) * own
    vectors = relative.as_rotvec()
    back = np.linalg.inv(_turns_by_vectors(vectors))
    by_tension, by_unknown = back @ outputs.by_tension[:, rows], back @ m.by_scales(outputs, rows)
    turn = back @ np.swapaxes(own.as_matrix(), 1, 2) @ _turn_by_vector(vector)
    for k, angle in enumerate(TURN):
        if (column := m.unknowns.index(angle)) is not None:
            by_unknown[:, :, column] += turn[:, :, k]
    return vectors, by_tension, by_unknown


def _contact_force(m: Measured, name: str, outputs: Outputs, tensions: np.ndarray, values: dict[str, float]) -> Rows:
    """Contact force of the object."""
    rows = [outputs.by_tension.shape[1] - 1]
    return outputs.contact_force[:, None], outputs.by_tension[:, rows], m.by_scales(outputs, rows)


_ROWS = {"position": _position, "orientation": _orientation, "contact_force": _contact_force}


def _cross(vectors: np.ndarray) -> np.ndarray:
    """Matrices of cross products, shape (n, 3, 3)."""
    x, y, z = vectors.T
    zero = np.zeros_like(x)
    return np.moveaxis(np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]), 2, 0)


def _turn_by_vector(vector: np.ndarray) -> np.ndarray:
    """Turn about the rotated axes by the change of a rotation vector, shape (3, 3)."""
    return _turns_by_vectors(vector[None])[0]


def _turns_by_vectors(vectors: np.ndarray) -> np.ndarray:
    """The same of n vectors, shape (n, 3, 3): 1 - (1 - cos a) / a^2 [v] + (a - sin a) / a^3 [v]^2, with a = |v|."""
    a = np.linalg.norm(vectors, axis=1)[:, None, None]
    cross = _cross(vectors)
    near = a < 1e-4
    safe = np.where(near, 1.0, a)
    first = np.where(near, 0.5 - a**2 / 24, (1 - np.cos(safe)) / safe**2)
    second = np.where(near, 1 / 6 - a**2 / 120, (safe - np.sin(safe)) / safe**3)
    return np.eye(3) - first * cross + second * cross @ cross
