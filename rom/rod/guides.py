"""A finger whose tendons rub in their guides: increments that follow how its motors pull and release."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from rom.brief import brief
from rom.checked_file import ModelError
from rom.native import LIBRARY, PickledByFields
from rom.rod.compiled import guides
from rom.rod.compiled.reports import QUATERNION
from rom.rod.rod import Rod
from rom.rod.touched_rod import TouchedRod

HALVINGS = 8  # of an increment that finds no equilibrium
Status = Literal["converged", "out_of_domain", "no_equilibrium"]


@brief
class GuideState(NamedTuple):
    """A finger with t tendons and n elements before m objects, at the end of an increment.

    Attributes:
        status: `out_of_domain` where the elements were not trained, here or on the way; `no_equilibrium` if none was
            found: then all numbers are nan, and the finger is where it was before.
        tensions: at the motors, shape (t,) [N].
        shortenings: of the tendons between the clamp and their plates, shape (t,) [m].
        element_tensions: segment by segment, each from its plate to its clamp, shape (n, t) [N].
        tip: displacement of the tip plate's centre, shape (3,) [m].
        orientation: of the tip plate's frame, as a unit quaternion w, x, y, z, shape (4,) [-].
        contact_forces: shape (m,) [N].
        jacobian: of the tip and the contact forces by the tensions at the motors and every d, where all tendons keep
            how they move in their guides, shape (3 + m, t + m). In contact, a tendon that sticks is taken to keep its
            shortenings at fixed wrenches.
        tip_error: estimated, without that of the law of friction [m].
        work: of the motors since the beginning [J].
        dissipated: by friction in the guides since the beginning [J].
    """

    status: Status
    tensions: np.ndarray
    shortenings: np.ndarray
    element_tensions: np.ndarray
    tip: np.ndarray
    orientation: np.ndarray
    contact_forces: np.ndarray
    jacobian: np.ndarray
    tip_error: float
    work: float
    dissipated: float


@brief
@dataclass(kw_only=True)
class GuidedFinger(PickledByFields):
    """A finger with Coulomb friction of its tendons in their channels, as its motors have pulled and released so far.

    Between neighbouring elements, a tension differs by at most exp(friction |turning|), and by a constant per length.
    Tendons that run straight have no guides.

    Attributes:
        model: the finger, alone or before its objects.
        friction: coefficient of all tendons, or of each, shape (t,) [-].
        per_length: friction besides [N/m].

    Raises:
        ModelError: friction or per_length negative or not finite, or the model has no shortenings.

    Example:
        >>> finger = GuidedFinger(model=TouchedSegment.load(), friction=0.2)
        >>> pulled, released = [finger.advance([tension, 0.0, 0.05]) for tension in (60.0, 30.0)]
    """

    model: Rod | TouchedRod
    friction: float | Sequence[float]
    per_length: float = 0.0
    arrays: guides.GuideArrays = field(init=False, repr=False)
    work: float = field(init=False, default=0.0, repr=False)
    dissipated: float = field(init=False, default=0.0, repr=False)
    inside: bool = field(init=False, default=True, repr=False)

    def __post_init__(self) -> None:
        friction, per_length = np.array(self.friction, float), float(self.per_length)
        t = len(self.rod.names)
        if friction.shape not in ((), (t,)) or not ((friction >= 0) & (friction < np.inf)).all():
            raise ModelError(f"friction must be a number of at least 0, or {t} of these, got {self.friction}")
        if not 0 <= per_length < np.inf:
            raise ModelError(f"per_length must be a number of at least 0 N/m, got {self.per_length}")
        if not all(one.struct.sixes for one in self.rod.segments):
            raise ModelError("the model must have shortenings of tendons, got none: train it anew (rom build)")
        in_channel = np.array([one.get("path", "channel") == "channel" for one in self.rod.scene["tendons"]])
        lengths = np.concatenate([[one.length for one in own] for own in self.rod.pieces])
        lengths[np.cumsum([0, *map(len, self.rod.pieces[:-1])])] -= [one.half_lengths[0] for one in self.rod.segments]
        n, loads = len(lengths), LIBRARY.functions.fingerfem_chain_loads(self.rod.struct)
        self.arrays = guides.GuideArrays(
            friction * in_channel,
            per_length * lengths[:, None] * in_channel,
            *(np.zeros(shape) for shape in ((n, t), (n, t, t), (n,), (n, t), (t,), (loads,))),
        )
        self.rest()

    def __getstate__(self) -> dict[str, Any]:
        """A copy has a history of its own."""
        return super().__getstate__() | {"arrays": guides.GuideArrays(*(one.copy() for one in self.arrays))}

    @property
    def rod(self) -> Rod:
        """The finger alone."""
        return self.model if isinstance(self.model, Rod) else self.model.rod

    @property
    def names(self) -> list[str]:
        """Names of the tensions, then of every d."""
        return [one.name for one in self.model.parameters]

    @cached_property
    def _touching(self) -> Any:
        if isinstance(self.model, Rod):
            return guides.guided(self.rod.struct, LIBRARY.ffi.NULL, 0, self.arrays)
        given = self.model.touching
        return guides.guided(self.rod.struct, given.objects, given.count, self.arrays)

    @property
    def _rubs(self) -> bool:
        return bool(self.arrays.friction.any() or self.arrays.drag.any())

    def rest(self) -> None:
        """Back to the finger with the least tensions, on which nothing has rubbed yet."""
        for one in self.arrays[2:]:
            one[...] = 0.0
        self.arrays.motors[:] = [one.lower for one in self.rod.parameters]
        self.arrays.tensions[:] = self.arrays.motors
        self.arrays.rates[:] = np.eye(len(self.arrays.motors))
        self.work, self.dissipated, self.inside = 0.0, 0.0, True

    def advance(self, point: ArrayLike, wound: Collection[str] = ()) -> GuideState:
        """One increment to a point: the tendons slip in one direction each, or stick.

        An increment that finds no equilibrium is divided.

        Args:
            point: tensions at the motors, or shortenings of the tendons that are wound, then every d, shape (t + m,)
                [N, m]. A tendon that is let out farther than its way is slack: it has the least tension.
            wound: names of the tendons whose motors are driven by position.

        Raises:
            ModelError: the wrong number of parameters, numbers that are not finite, or another name.
        """
        given, names = np.asarray(point, float), self.rod.names
        if given.shape != (len(self.names),) or not np.isfinite(given[: len(names)]).all() or np.isnan(given).any():
            raise ModelError(f"point must be finite numbers {', '.join(self.names)}, got {point!r}")
        if unknown := set(wound) - set(names):
            raise ModelError(f"wound must be of {', '.join(names)}, got {sorted(unknown)[0]}")
        winds = np.array([name in wound for name in names])
        kept = self.arrays.keep(), self.work, self.dissipated, self.inside
        if not self._reach(given, winds, HALVINGS):
            self.arrays.restore(kept[0])
            _, self.work, self.dissipated, self.inside = kept
            return self._nothing()
        return self._state(given[len(names) :])

    def _reach(self, goal: np.ndarray, wound: np.ndarray, halvings: int) -> bool:
        """One increment, or two halves of it."""
        kept = self.arrays.keep()
        steps, work, inside = guides.advance(self._touching, self.arrays, goal, wound)
        if steps > 0:
            self.work, self.dissipated = self.work + float(work[0]), self.dissipated + float(work[1])
            self.inside &= inside
            return True
        self.arrays.restore(kept)
        if not halvings:
            return False
        t = len(wound)
        between = goal.copy()
        begun = np.where(wound, self._shortenings(), self.arrays.motors)
        between[:t] = (begun + goal[:t]) / 2
        return self._reach(between, wound, halvings - 1) and self._reach(goal, wound, halvings - 1)

    def _shortenings(self) -> np.ndarray:
        """At the clamp, where the last element of the first segment ends, shape (t,) [m]."""
        return self.arrays.slips[len(self.rod.pieces[0]) - 1]

    def _state(self, distances: np.ndarray) -> GuideState:
        m = len(distances)
        if not self._rubs:  # as `evaluate`, from rest
            self.arrays.loads[:] = 0.0
        found = guides.answer(self._touching, self.arrays, distances)
        self.inside &= found.inside
        return GuideState(
            status="converged" if self.inside else "out_of_domain",
            tensions=self.arrays.motors.copy(),
            shortenings=found.reports.rows[0, QUATERNION:],
            element_tensions=self.arrays.tensions.copy(),
            tip=found.out[:3],
            orientation=found.reports.rows[0, :QUATERNION],
            contact_forces=found.out[3 : 3 + m],
            jacobian=found.jacobian[: 3 + m],
            tip_error=float(found.errors[0]),
            work=self.work,
            dissipated=self.dissipated,
        )

    def _nothing(self) -> GuideState:
        """The state that no equilibrium was found for."""
        t, m = len(self.rod.names), len(self.names) - len(self.rod.names)
        return GuideState(
            status="no_equilibrium",
            tensions=np.full(t, np.nan),
            shortenings=np.full(t, np.nan),
            element_tensions=np.full(self.arrays.tensions.shape, np.nan),
            tip=np.full(3, np.nan),
            orientation=np.full(QUATERNION, np.nan),
            contact_forces=np.full(m, np.nan),
            jacobian=np.full((3 + m, t + m), np.nan),
            tip_error=np.nan,
            work=np.nan,
            dissipated=np.nan,
        )


def guide_history(
    model: Rod | TouchedRod,
    points: ArrayLike,
    friction: float | Sequence[float],
    per_length: float = 0.0,
    wound: Collection[str] = (),
    increments: int = 4,
) -> list[GuideState]:
    """States along a history of motors, from rest, from point to point in straight lines.

    Args:
        model: a finger, alone or before objects.
        points: tensions at the motors, or shortenings of wound tendons, then every d, shape (points, t + m) [N, m].
        friction: coefficient of all tendons in their guides, or of each, shape (t,) [-].
        per_length: friction besides [N/m].
        wound: names of the tendons whose motors are driven by position.
        increments: from point to point; what slips and what sticks is decided once in each.

    Raises:
        ModelError: see `GuidedFinger`; or no increment.

    Example:
        >>> guide_history(TouchedSegment.load(), [[60, 0, 0.05], [30, 0, 0.05]], 0.2)[-1].element_tensions
    """
    finger, rows = (
        GuidedFinger(model=model, friction=friction, per_length=per_length),
        np.atleast_2d(np.asarray(points, float)),
    )
    if increments < 1:
        raise ModelError(f"increments must be at least 1, got {increments}")
    if rows.shape[1:] != (len(finger.names),):
        raise ModelError(f"points must be rows of {', '.join(finger.names)}, got shape {rows.shape}")
    begun, found = rows[0].copy(), []
    begun[: len(finger.rod.names)] = [0.0 if one.name in wound else one.lower for one in finger.rod.parameters]
    for row in rows:
        for k in range(1, 1 + increments):
            share = k / increments
            state = finger.advance(row if k == increments else begun + share * (row - begun), wound)
        found.append(state)
        begun = row
    return found
