"""A finger that objects touch: a model of tensions, pressures and every object's distance."""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from rom.answer import Answer
from rom.brief import brief
from rom.console.table import Table, parameters
from rom.files.checked_file import ModelError
from rom.native import LIBRARY, PickledByFields
from rom.parameter import Parameter, joined
from rom.parametric_model import ParametricModel
from rom.rod.compiled.evaluation import Evaluation, evaluate
from rom.rod.compiled.touched import Touched, pressing, touches
from rom.rod.objects.shapes import RigidObject
from rom.rod.report import FingerReport
from rom.rod.rod import QUANTITIES, Rod
from rom.rod.shape import Sections

MOST = LIBRARY.constants.FINGERFEM_MOST_OBJECTS


@brief
class ContactForce(NamedTuple):
    """Force of an object on the finger at a point.

    Attributes:
        plate: which, from the clamp; or the one that the touched rubber ends at.
        place: of the point in space, shape (3,) [m].
        normal: out of the object, shape (3,) [-].
        force: on the plate, shape (3,) [N].
        slides: true if the contact slides, false if it sticks. Without friction it always slides.
        rubber: whether the point is of the rubber.
        object: which, of several.
    """

    plate: int
    place: np.ndarray
    normal: np.ndarray
    force: np.ndarray
    slides: bool
    rubber: bool = False
    object: int = 0


@brief
@dataclass(frozen=True, kw_only=True)
class TouchedRod(ParametricModel, PickledByFields):
    """A finger of one segment or several, and m rigid objects without friction that touch it anywhere.

    Attributes:
        rod: the finger.
    """

    rod: Rod

    @property
    @abstractmethod
    def objects(self) -> tuple[RigidObject, ...]:
        """Objects that may touch the finger."""

    @property
    def distance_names(self) -> list[str]:
        """Names of the objects' distances."""
        return [f"d{k + 1}" for k in range(len(self.objects))]

    @cached_property
    def parameters(self) -> list[Parameter]:
        """Tensions and pressures, then the distance of every object."""
        ends = [(name, *one.distances) for name, one in zip(self.distance_names, self.objects, strict=True)]
        return [
            *self.rod.parameters,
            *(Parameter(name, "m", nearest, farthest) for name, nearest, farthest in ends),
        ]

    def tables(self) -> list[Table | str]:
        """Tables for people: the finger's segments, and the ranges of objects' distances."""
        return [
            *self.rod.tables(),
            parameters(self.parameters, "with objects" if len(self.objects) > 1 else "with the object"),
        ]

    @cached_property
    def touching(self) -> Any:
        """Struct fingerfem_touching for compiled code."""
        objects = [LIBRARY.struct("fingerfem_object", **one.numbers()) for one in self.objects]
        return LIBRARY.struct(
            "fingerfem_touching",
            chain=self.rod.struct,
            count=len(objects),
            objects=LIBRARY.pointers("fingerfem_object", objects),
        )

    def with_gravity(self, direction: ArrayLike, acceleration: float | None = None) -> Self:
        """The same before the same objects, on a base that is turned; see `Rod.with_gravity`."""
        return replace(self, rod=self.rod.with_gravity(direction, acceleration))

    def answers(self, points: ArrayLike, by_object: bool = False) -> Touched:
        """Answers, with all that is known of them, at points, shape (n, p) [N, m].

        With `by_object`, derivatives with respect to the objects' poses are included: for each object in turn, by a
        translation along x, y, z, then by a rotation about axes through its centre.

        Raises:
            ModelError: the wrong number of parameters.
        """
        return touches(self.touching, self._points(points), by_object=by_object)

    def _points(self, parameters: ArrayLike) -> np.ndarray:
        """Points as rows."""
        return np.atleast_2d(self.checked(parameters))

    def evaluate(self, parameters: ArrayLike, d: ArrayLike | None = None) -> Answer:
        """Tip, its orientation, contact forces, touch distances and tendon shortenings at tensions [N] and every d [m].

        Args:
            parameters: shape (p,) or (n, p); tensions alone, shape (t,) or (n, t), if d is given.
            d: see `rom.parameter.joined`.

        All objects approach the finger simultaneously. If no equilibrium was found on their approach, the answer is
        not inside, and its error infinite. It is not inside either if the equilibrium is not stable. Arrays with one
        value per object have a last axis of length m.

        Raises:
            ModelError: the wrong number of parameters.
        """
        m = len(self.objects)
        parameters = parameters if d is None else joined(parameters, d, m)
        evaluation = evaluate(self.touching, self._points(parameters))
        (out, errors, inside, _), report = evaluation, self._report(evaluation)
        if np.ndim(parameters) == 1:
            out, errors, inside, report = out[0], errors[0], inside[0], FingerReport(*(one[0] for one in report))
        return Answer(
            tip=out[..., :3],
            contact_force=out[..., 3 : 3 + m],
            touch_distance=out[..., 3 + m :],
            pad_pressure=None,
            error=dict(zip(QUANTITIES, (errors[..., 0], errors[..., 1 : 1 + m], errors[..., 1 + m :]), strict=True)),
            inside=inside,
            orientation=report.orientation,
            orientation_error=report.orientation_error,
            shortenings=report.shortenings,
            shortening_error=report.shortening_error,
            **({"growths": report.growths, "growth_error": report.growth_error} if report.growths.size else {}),
        )

    def report(self, parameters: ArrayLike) -> FingerReport:
        """Tip orientation, shortenings and growths, with their derivatives by tensions, pressures and every d.

        Args:
            parameters: shape (p,) or (n, p).

        Raises:
            ModelError: the wrong number of parameters.

        Example:
            >>> TouchedSegment.load().report([30.0, 0.0, 0.010]).shortening_jacobian
        """
        reports = self._report(evaluate(self.touching, self._points(parameters)))
        return FingerReport(*(one[0] for one in reports)) if np.ndim(parameters) == 1 else reports

    def _report(self, evaluation: Evaluation) -> FingerReport:
        return FingerReport.of(evaluation, len(self.rod.scene["tendons"]), self.rod.errors.growth)

    def contact_forces(self, parameters: ArrayLike) -> list[ContactForce]:
        """Forces of objects at one point of parameters, shape (p,); none without an equilibrium.

        A plate is rigid. If its wrench does not determine all of its contacts' forces, they are one of many solutions.
        """
        (point,) = self._points(parameters)
        contacts = pressing(self.touching, point)
        least = 1e-6 * contacts.forces.max(initial=0.0)
        return [
            ContactForce(int(plate), place, normal, force * normal, True, bool(rubber), int(number))
            for plate, number, rubber, place, normal, force in zip(*contacts, strict=True)
            if force > least
        ]

    def displacement(self, parameters: ArrayLike, points: ArrayLike | None = None) -> np.ndarray:
        """Displacements of material points at one point of the parameters, shape (p,); returns shape (points, 3) [m].

        Args:
            parameters: tensions [N] and every d [m].
            points: of the finger at rest, shape (points, 3) [m]; by default the long edges' at even cross-sections.
        """
        tensions, wrenches = self._loads(parameters)
        return self.rod.displacement(tensions, wrenches, points)

    def sections(self, parameters: ArrayLike, at: ArrayLike | None = None) -> Sections:
        """Poses of cross-sections at one point of the parameters, shape (p,), pressed or free; see `Rod.sections`.

        Args:
            parameters: tensions [N] and every d [m].
            at: positions along the finger at rest, shape (m,) [m].
        """
        return self.rod.sections(*self._loads(parameters), at)

    def shortening(self, parameters: ArrayLike) -> np.ndarray:
        """Shortenings of the tendons at one point of parameters, shape (p,); shape (tendons,) [m]."""
        return self.rod.shortening(*self._loads(parameters))

    def growth(self, parameters: ArrayLike) -> np.ndarray:
        """Growths of the chambers at one point of parameters, shape (p,); shape (chambers,) [m^3]."""
        return self.rod.growth(*self._loads(parameters))

    def _loads(self, parameters: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Tensions and loads in contact, shapes (t,) [N] and (m,) [N, N m]."""
        return np.asarray(parameters, float)[: -len(self.objects)], self.answers(parameters).loads[0]

    def value_and_jacobian(self, parameters: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Tip x, y, z [m], contact forces [N], touch distances [m], shape (3 + 2 m,); and `jacobian`."""
        answer = self.answers(parameters)
        return answer.out[0], answer.jacobians[0]


@brief
@dataclass(frozen=True, kw_only=True)
class AmongObjects(TouchedRod):
    """A finger among several objects, each with its own distance: d1, d2, and so on.

    Attributes:
        obstacles: one to eight objects.

    Example:
        >>> post = Cylinder(centre=(0.08, 0.02, 0.0), direction=(0.0, 1.0, 0.0), radius=0.008)
        >>> model = AmongObjects(rod=Rod.load("finger.h5"), obstacles=[post, another])  # doctest: +SKIP
        >>> model.evaluate([60.0, 0.0, 0.0, 0.02]).contact_force  # doctest: +SKIP
    """

    obstacles: Sequence[RigidObject]

    def __post_init__(self) -> None:
        if not 1 <= len(self.obstacles) <= MOST:
            raise ModelError(f"obstacles must be 1 to {MOST}, got {len(self.obstacles)}")

    @property
    def objects(self) -> tuple[RigidObject, ...]:
        """The obstacles."""
        return tuple(self.obstacles)
