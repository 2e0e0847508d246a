"""A finger that an object touches: a model of tensions and the object's distance."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from rom.brief import brief
from rom.checked_file import ModelError
from rom.native import PickledByFields
from rom.native.answer import Answer
from rom.rod import native
from rom.rod.native import SEGMENT, Touched
from rom.rod.native.reports import QUATERNION
from rom.rod.native.told import tells
from rom.rod.objects.shapes import Object, facing_plane
from rom.rod.report import Report
from rom.rod.rod import QUANTITIES, Rod
from rom.rod.shape import Sections
from rom.table import Table, as_html, parameters

SHIPPED = Path(__file__).parents[1] / "finger.h5"  # made by `make model`


@brief
class ContactForce(NamedTuple):
    """What the object does to the finger at a point.

    Attributes:
        plate: which, from the clamp; or the one that the touched rubber ends at.
        place: of the point in space, shape (3,) [m].
        normal: out of the object, shape (3,) [-].
        force: on the plate, shape (3,) [N].
        slides: or sticks; without friction it slides.
        rubber: whether the point is of the rubber.
    """

    plate: int
    place: np.ndarray
    normal: np.ndarray
    force: np.ndarray
    slides: bool
    rubber: bool = False


@brief
@dataclass(frozen=True, kw_only=True)
class TouchedSegment(PickledByFields):
    """A finger of one segment or several, and a rigid object without friction that touches it anywhere.

    Attributes:
        rod: the finger.
        obstacle: what touches.
    """

    rod: Rod
    obstacle: Object
    has_obstacle: bool = field(default=True, init=False)
    has_pad: bool = field(default=False, init=False)

    @classmethod
    def load(cls, path: str | Path | None = None) -> TouchedSegment:
        """Read a finger; it stands before the plane y = side/2 + d, d from 0 to the finger's length.

        Args:
            path: the file; None reads the bundled finger.

        Raises:
            ModelError: no file, no finger of elements, a damaged one, or one of another format.

        Example:
            >>> model = TouchedSegment.load()
            >>> model.evaluate([30.0, 0.0, 0.010]).contact_force
        """
        rod = Rod.load(path or SHIPPED)
        geometry = rod.scene["geometry"]
        return cls(rod=rod, obstacle=facing_plane(geometry["side"], (0.0, sum(geometry["segments"]))))

    @property
    def parameters(self) -> list[dict[str, Any]]:
        """Name, unit, lower and upper of tensions and d."""
        nearest, farthest = self.obstacle.distances
        return [*self.rod.parameters, {"name": "d", "unit": "m", "lower": nearest, "upper": farthest}]

    @property
    def names(self) -> list[str]:
        """Of the parameters."""
        return [parameter["name"] for parameter in self.parameters]

    @property
    def limits(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper ends of the parameters, shapes (p,) [N, m]."""
        ends = np.array([[parameter["lower"], parameter["upper"]] for parameter in self.parameters])
        return ends[:, 0], ends[:, 1]

    @property
    def scene(self) -> dict[str, Any]:
        """The trained scene."""
        return self.rod.scene

    def tables(self) -> list[Table | str]:
        """For people: its segments, and where the object may be."""
        return [*self.rod.tables(), parameters(self.parameters, "with the object")]

    def _repr_html_(self) -> str:
        return as_html(self.tables())

    @cached_property
    def lead(self) -> int:
        """The tension that pushes most towards the object, in the middle of the others' range."""
        lower, upper = self.limits
        middle = np.append((lower + upper)[:-1] / 2, np.inf)
        return int(np.argmax(native.touches(self.touching, middle[None]).jacobians[0, 4, :-1]))

    @cached_property
    def touching(self) -> Any:
        """For compiled code, a struct fingerfem_touching."""
        return SEGMENT.struct(
            "fingerfem_touching",
            chain=self.rod.struct,
            object=SEGMENT.struct("fingerfem_object", **self.obstacle.numbers()),
        )

    @property
    def direction(self) -> np.ndarray:
        """Unit vector along which d moves the object away, shape (3,) [-]."""
        return np.array(self.obstacle.numbers()["direction"])

    def rubber_gap(self, point: np.ndarray, wrenches: np.ndarray) -> float:
        """The rubber's least distance from the object under loads, see `Rod.place` [m]; infinite if unknown."""
        given = np.array(point, float), native.loads(self.rod.struct, np.asarray(wrenches, float))
        memory = native.memory_of(self.rod.struct)
        return float(SEGMENT.functions.fingerfem_rubber_gap(self.touching, *map(native.pointer, given), memory))

    @property
    def native(self) -> dict[str, Any]:
        """What compiled controllers ask."""
        return {"touching": self.touching}

    def outputs(self, points: np.ndarray) -> np.ndarray:
        """Tip [m], contact force [N] and touch distance [m], shape (n, 5), at points, shape (n, p)."""
        return self.answers(points).out

    def answers(self, points: ArrayLike, by_object: bool = False) -> Touched:
        """Answers, with all that is known of them, at points, shape (n, p) [N, m].

        Derivatives by the object's pose, if wanted, are those with a motion of it along x, y, z, then with a turning of
        it about axes through its centre.

        Raises:
            ModelError: the wrong number of parameters.
        """
        return native.touches(self.touching, self._points(points), by_object=by_object)

    def _points(self, parameters: ArrayLike) -> np.ndarray:
        """Points as rows."""
        found = np.atleast_2d(np.asarray(parameters, float))
        if found.ndim > 2 or found.shape[-1] != len(self.parameters):
            raise ModelError(
                f"parameters must be {', '.join(self.names)} (in that order), got shape {np.shape(parameters)}"
            )
        return found

    def evaluate(self, parameters: ArrayLike) -> Answer:
        """Tip, its orientation, contact force, touch distance and tendon shortenings at tensions [N] and d [m].

        Args:
            parameters: shape (p,) or (n, p).

        Where no equilibrium was found on the object's approach, the answer is not inside, and its error infinite. It is
        not inside either where the equilibrium is not stable.

        Raises:
            ModelError: the wrong number of parameters.
        """
        out, errors, inside, (rows, _, off) = tells(self.touching, self._points(parameters))
        if np.ndim(parameters) == 1:
            out, errors, inside, rows, off = out[0], errors[0], inside[0], rows[0], off[0]
        return Answer(
            tip=out[..., :3],
            contact_force=out[..., 3],
            touch_distance=out[..., 4],
            pad_pressure=None,
            error=dict(zip(QUANTITIES, errors.T, strict=True)),
            inside=inside,
            orientation=rows[..., :QUATERNION],
            orientation_error=off[..., 0],
            shortenings=rows[..., QUATERNION:],
            shortening_error=off[..., 1],
        )

    def report(self, parameters: ArrayLike) -> Report:
        """Tip orientation and tendon shortenings, with their derivatives by tensions [N] and d [m].

        Args:
            parameters: shape (p,) or (n, p).

        Raises:
            ModelError: the wrong number of parameters.

        Example:
            >>> TouchedSegment.load().report([30.0, 0.0, 0.010]).shortening_jacobian
        """
        found = Report.of(tells(self.touching, self._points(parameters)))
        return Report(*(one[0] for one in found)) if np.ndim(parameters) == 1 else found

    def contact_forces(self, parameters: ArrayLike) -> list[ContactForce]:
        """Where the object presses at one point, shape (p,), and how much; none without an equilibrium.

        A plate is rigid: of more contacts than its wrench tells apart, the forces are one way of making it.
        """
        (point,) = self._points(parameters)
        found = native.pressing(self.touching, point)
        least = 1e-6 * found.forces.max(initial=0.0)
        return [
            ContactForce(int(plate), place, normal, force * normal, slides=True, rubber=bool(rubber))
            for plate, rubber, place, normal, force in zip(*found, strict=True)
            if force > least
        ]

    def displacement(self, parameters: ArrayLike, points: ArrayLike | None = None) -> np.ndarray:
        """Of material points at one point of the parameters, shape (p,); shape (points, 3) [m].

        Args:
            parameters: tensions [N] and d [m].
            points: of the finger at rest, shape (points, 3) [m]; by default the long edges' at even cross-sections.
        """
        tensions, wrenches = self._loads(parameters)
        return self.rod.displacement(tensions, wrenches, points)

    def sections(self, parameters: ArrayLike, at: ArrayLike | None = None) -> Sections:
        """Poses of cross-sections at one point of the parameters, shape (p,), pressed or free; see `Rod.sections`.

        Args:
            parameters: tensions [N] and d [m].
            at: positions along the finger at rest, shape (m,) [m].
        """
        return self.rod.sections(*self._loads(parameters), at)

    def shortening(self, parameters: ArrayLike) -> np.ndarray:
        """How much shorter the tendons have become at one point, shape (p,); shape (t,) [m]."""
        return self.rod.shortening(*self._loads(parameters))

    def _loads(self, parameters: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Tensions and loads in contact, shapes (t,) [N] and (m,) [N, N m]."""
        return np.asarray(parameters, float)[:-1], self.answers(parameters).loads[0]

    def value_and_jacobian(self, parameters: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Tip x, y, z [m], contact force [N], touch distance [m], shape (5,), and derivatives, shape (5, p)."""
        found = self.answers(parameters)
        return found.out[0], found.jacobians[0]

    def jacobian(self, parameters: ArrayLike) -> np.ndarray:
        """The derivatives alone, shape (5, p)."""
        return self.answers(parameters).jacobians[0]
