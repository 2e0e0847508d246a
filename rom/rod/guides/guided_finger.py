"""A finger with friction of its tendons in their guides, in increments of the motors' history."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from rom.brief import brief
from rom.files.checked_file import ModelError
from rom.native import LIBRARY, PickledByFields
from rom.rod.compiled import guides
from rom.rod.compiled.reports import QUATERNION
from rom.rod.rod import Rod
from rom.rod.touched_rod import TouchedRod

HALVINGS = 8  # of an increment that finds no equilibrium
PULLED, MOVED = 5e-4, 5e-6  # half widths of central differences: over the range of a load [-], and of distances [m]
Status = Literal["converged", "out_of_domain", "no_equilibrium"]


@brief
class GuideState(NamedTuple):
    """A finger with t tensions and pressures and n elements before m objects, at the end of an increment.

    Attributes:
        status: `out_of_domain` where the elements were not trained, now or earlier in the history; `no_equilibrium`
            if none was found: then all numbers are nan, and the finger keeps its state from before.
        tensions: at the motors, then pressures, shape (t,) [N, Pa].
        shortenings: of the tendons between the clamp and their plates, shape (tendons,) [m].
        element_tensions: segment by segment, each from its plate to its clamp, shape (n, t) [N, Pa].
        tip: displacement of the tip plate's centre, shape (3,) [m].
        orientation: of the tip plate's frame, as a unit quaternion w, x, y, z, shape (4,) [-].
        contact_forces: shape (m,) [N].
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
    tip_error: float
    work: float
    dissipated: float


@brief
class Increment(NamedTuple):
    """The last increment: the arrays where it began, its point, and which motors wound."""

    begun: list[np.ndarray]
    point: np.ndarray
    wound: np.ndarray


@brief
@dataclass(kw_only=True)
class GuidedFinger(PickledByFields):
    """A finger with Coulomb friction of its tendons in their channels, which depends on the history of its motors.

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
    last: Increment | None = field(init=False, default=None, repr=False)

    def __post_init__(self) -> None:
        friction, per_length = np.array(self.friction, float), float(self.per_length)
        t = len(self.rod.names)
        if friction.shape not in ((), (t,)) or not ((friction >= 0) & (friction < np.inf)).all():
            raise ModelError(f"friction must be a number of at least 0, or {t} of these, got {self.friction}")
        if not 0 <= per_length < np.inf:
            raise ModelError(f"per_length must be a number of at least 0 N/m, got {self.per_length}")
        if not all(one.struct.sixes for one in self.rod.segments):
            raise ModelError("the model must have shortenings of tendons, got none: train it anew (rom build)")
        in_channel = np.zeros(t, bool)  # straight tendons have no guides, nor have the pressures behind the tensions
        in_channel[: len(self._tendons)] = [one.get("path", "channel") == "channel" for one in self._tendons]
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
    def _tendons(self) -> list[dict[str, Any]]:
        tendons: list[dict[str, Any]] = self.rod.scene["tendons"]
        return tendons

    @property
    def names(self) -> list[str]:
        """Names of the tensions and pressures, then of every d."""
        return [one.name for one in self.model.parameters]

    @cached_property
    def touching(self) -> Any:
        """For compiled code, a struct fingerfem_touching of which every element has the tensions of `arrays`."""
        if isinstance(self.model, Rod):
            return guides.guided(self.rod.struct, LIBRARY.ffi.NULL, 0, self.arrays)
        given = self.model.touching
        return guides.guided(self.rod.struct, given.objects, given.count, self.arrays)

    @property
    def _rubs(self) -> bool:
        return bool(self.arrays.friction.any() or self.arrays.drag.any())

    def rest(self) -> None:
        """Start the history again, at the lowest tensions and without friction forces."""
        for one in self.arrays[2:]:
            one[...] = 0.0
        self.arrays.motors[:] = [one.lower for one in self.rod.parameters]
        self.arrays.tensions[:] = self.arrays.motors
        self.arrays.rates[:] = np.eye(len(self.arrays.motors))
        self.work, self.dissipated, self.inside, self.last = 0.0, 0.0, True, None

    def advance(self, point: ArrayLike, wound: Collection[str] = ()) -> GuideState:
        """One increment to a point, in which each tendon slips in one direction, or sticks.

        An increment without an equilibrium is halved.

        Args:
            point: tensions at the motors, or shortenings of wound tendons, then pressures and every d, shape (t + m,)
                [N, m, Pa]. A wound tendon that is too long is slack: it has the lowest tension.
            wound: names of the tendons whose motors are driven by position.

        Raises:
            ModelError: the wrong number of parameters, numbers that are not finite, or another name.
        """
        given, names = np.asarray(point, float), self.rod.names
        if given.shape != (len(self.names),) or not np.isfinite(given[: len(names)]).all() or np.isnan(given).any():
            raise ModelError(f"point must be finite numbers {', '.join(self.names)}, got {point!r}")
        tendons = [one["name"] for one in self._tendons]
        if unknown := set(wound) - set(tendons):
            raise ModelError(f"wound must be of {', '.join(tendons)}, got {sorted(unknown)[0]}")
        winds = np.array([name in wound for name in names])
        kept = self.arrays.keep(), self.work, self.dissipated, self.inside
        if not self._reach(given, winds, HALVINGS):
            self.arrays.restore(kept[0])
            _, self.work, self.dissipated, self.inside = kept
            return self._nothing()
        self.last = Increment(kept[0], given, winds)
        return self._state(given[len(names) :])

    def jacobian(self) -> np.ndarray:
        """Derivatives of tip and contact forces after the last increment by its point, shape (3 + m, t + m).

        Elimination computes those of a finger without load, central differences of the increment all others, in about a
        millisecond. If a motor has just reversed there are two derivatives; differences return their mean.

        Raises:
            ModelError: there was no increment yet, or a neighbouring one has no equilibrium.
        """
        if self.last is None:
            raise ModelError("advance must be called before jacobian, got no increment yet")
        (begun, point, wound), t = self.last, len(self.rod.names)
        if not self.arrays.loads.any() and "gravity" not in self.rod.scene and not wound.any():
            return guides.answer(self.touching, self.arrays, point[t:]).jacobian[: 3 + len(point) - t]
        kept = self.arrays.keep(), self.work, self.dissipated, self.inside
        columns = []
        try:
            for k, one in enumerate(self.model.parameters):
                step = MOVED if k >= t or wound[k] else PULLED * (one.upper - one.lower)
                sides = []
                for way in (step, -step):
                    self.arrays.restore(begun)
                    near = point + way * (np.arange(len(point)) == k)
                    if not self._reach(near, wound, HALVINGS):
                        where = f"{one.name} near {point[k]:g}"
                        raise ModelError(f"jacobian must have equilibria at {where}, got none")
                    answer = guides.answer(self.touching, self.arrays, near[t:])
                    sides.append(answer.out[: 3 + len(point) - t])
                columns.append((sides[0] - sides[1]) / (2 * step))
        finally:
            self.arrays.restore(kept[0])
            _, self.work, self.dissipated, self.inside = kept
        return np.stack(columns, axis=-1)

    def _reach(self, goal: np.ndarray, wound: np.ndarray, halvings: int) -> bool:
        """One increment, or two halves of it."""
        kept = self.arrays.keep()
        steps, work, inside = guides.advance(self.touching, self.arrays, goal, wound)
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
        answer = guides.answer(self.touching, self.arrays, distances)
        self.inside &= answer.inside
        return GuideState(
            status="converged" if self.inside else "out_of_domain",
            tensions=self.arrays.motors.copy(),
            shortenings=answer.reports.rows[0, QUATERNION : QUATERNION + len(self._tendons)],
            element_tensions=self.arrays.tensions.copy(),
            tip=answer.out[:3],
            orientation=answer.reports.rows[0, :QUATERNION],
            contact_forces=answer.out[3 : 3 + m],
            tip_error=float(answer.errors[0]),
            work=self.work,
            dissipated=self.dissipated,
        )

    def _nothing(self) -> GuideState:
        """The state of a point without an equilibrium."""
        t, m = len(self.rod.names), len(self.names) - len(self.rod.names)
        return GuideState(
            status="no_equilibrium",
            tensions=np.full(t, np.nan),
            shortenings=np.full(len(self._tendons), np.nan),
            element_tensions=np.full(self.arrays.tensions.shape, np.nan),
            tip=np.full(3, np.nan),
            orientation=np.full(QUATERNION, np.nan),
            contact_forces=np.full(m, np.nan),
            tip_error=np.nan,
            work=np.nan,
            dissipated=np.nan,
        )
