"""A separated model: tensions and the object's distance in; tip, contact force and touch distance with errors out.

    u(F, d) = u_0(F) + p v(F, s),   p = D(F) - d,   s = p / (D(F) - d_min),

u_0, D and v each a sum of products of one-dimensional functions (`rom.separated.form`); `rom.separated.tabulated`
makes them.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import h5py
import numpy as np
from numpy.typing import ArrayLike

from rom import answer, checked_file
from rom.answer import Answer
from rom.brief import brief
from rom.checked_file import ModelError
from rom.console.table import NOT_MEASURED, Table, accuracy, as_html, parameters
from rom.native import LIBRARY, PickledByFields, forms
from rom.parameter import Parameter, joined
from rom.separated import model_file
from rom.separated.form import Separated, tables

logger = logging.getLogger(__name__)

KIND, FORMAT = "fingerfem separated model", 2
FREE_SHARE = 0.01  # of a tolerance, for the free form: contact begins at its touch distance [-]


@brief
@dataclass(frozen=True, kw_only=True)
class Errors:
    """Estimated errors, meant to cover 95 % of the true ones.

    Attributes:
        tip: without contact [m].
        displacement: without contact, root mean square over the nodes [m]; 0 without the field.
        touch_distance: [m].
        contact: of tip, contact force, displacement and, if the model has it, pad pressure, per length of contact path
            [-, N/m, -, Pa/m], by cell, shape (cells, 3 or 4).
        margin: added to the contact path [m]. It is at least the error of the touch distance.
    """

    tip: float
    displacement: float
    touch_distance: float
    contact: np.ndarray
    margin: float


@brief
class Field(NamedTuple):
    """The displacement of all nodes by the model's own products.

    Attributes:
        nodes: at rest, shape (nodes, 3) [m].
        free: F_i of the free form, shape (3 nodes, terms) [m].
        contact: of the contact form, what contact adds per length of its path, likewise [-].
    """

    nodes: np.ndarray
    free: np.ndarray
    contact: np.ndarray


@brief
@dataclass(frozen=True, kw_only=True)
class SeparatedModel(PickledByFields):
    """A finger before one object, as sums of products of one-dimensional functions.

    Attributes:
        parameters: tensions first, then d.
        free: tip [m] and touch distance [m] without contact, by the tensions.
        contact: what contact adds per length of its path: tip [-], contact force [N/m] and, if the model has it, pad
            pressure [Pa/m]; by tensions and s.
        answered: cells of the box of tensions and s in which the samples support an answer, shape (cells,).
        errors: the estimated ones.
        displacements: of all nodes; None if the samples had none.
        lead: index of the tension that pushes most towards the object.
        scene: the sampled finger's.
        accuracy: error by quantity against what the samples are from; empty if it is not measured.
        provenance: what the samples are from.

    Example:
        >>> specialise(TouchedSegment.load()).evaluate([60.0, 20.0, 0.012]).contact_force  # doctest: +SKIP
    """

    parameters: list[Parameter]
    free: Separated
    contact: Separated
    answered: np.ndarray = field(repr=False)
    errors: Errors = field(repr=False)
    displacements: Field | None = field(repr=False, default=None)
    lead: int
    scene: dict[str, Any] = field(repr=False)
    accuracy: dict[str, dict[str, Any]]
    provenance: dict[str, Any]
    has_obstacle: ClassVar[bool] = True

    @property
    def names(self) -> list[str]:
        """Names of the parameters in order."""
        return [parameter.name for parameter in self.parameters]

    @property
    def has_pad(self) -> bool:
        """Whether it has the pad's pressure."""
        return len(self.contact.modes) > answer.FORCE + 1

    @property
    def cells(self) -> int:
        """Cells along every parameter."""
        return round(len(self.answered) ** (1 / len(self.parameters)))

    @cached_property
    def limits(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper end of the sampled box, shapes (p,)."""
        lower, upper = ([getattr(parameter, name) for parameter in self.parameters] for name in ("lower", "upper"))
        return np.array(lower, float), np.array(upper, float)

    @property
    def terms(self) -> dict[str, int]:
        """Number of terms of every form."""
        return {"free": self.free.terms, "contact": self.contact.terms}

    @property
    def bytes(self) -> int:
        """Size of its forms and estimated errors [B]."""
        forms = [part for form in (self.free, self.contact) for part in (form.modes, *form.functions)]
        return int(sum(part.nbytes for part in [*forms, self.answered, self.errors.contact.astype(np.float32)]))

    @cached_property
    def kernel(self) -> Any:
        """The arrays for the compiled answer, a struct fingerfem_kernel."""
        lower, upper = self.limits
        return LIBRARY.struct(
            "fingerfem_kernel",
            tables=tables([self.free, self.contact]),
            parameters=len(lower),
            has_pad=self.has_pad,
            cells=self.cells,
            lower=lower,
            upper=upper,
            answered=self.answered.astype(np.uint8),
        )

    @property
    def native(self) -> dict[str, Any]:
        """The fields that compiled controllers read: the arrays, and the rates of errors in contact."""
        contact = self.errors.contact
        return {"kernel": self.kernel, "rates": contact, "columns": contact.shape[1], "margin": self.errors.margin}

    def outputs(self, points: np.ndarray) -> np.ndarray:
        """Tip [m], contact force [N], touch distance [m], pad pressure [Pa] if the model has it, shape (n, 5 or 6)."""
        return forms.answers(self.kernel, points)[0]

    def evaluate(self, parameters: ArrayLike, d: ArrayLike | None = None) -> Answer:
        """Tip, contact force and touch distance at tensions [N] and d [m], shape (p,) or (n, p).

        If d is given, the parameters are tensions alone, see `rom.parameter.joined`.

        Raises:
            ModelError: the wrong number of parameters.
        """
        parameters = parameters if d is None else joined(parameters, d)
        point, errors = self._point(parameters, most=2), self.errors
        points = np.atleast_2d(point)
        out, inside = forms.answers(self.kernel, points)
        rates = forms.contact_errors(self.kernel, errors.contact, errors.margin, points, out[:, answer.TOUCH]).T
        late = np.full(len(points), errors.touch_distance)
        estimated = {"tip": errors.tip + rates[0], "contact_force": rates[1], "touch_distance": late}
        estimated |= {"pad_pressure": rates[3]} if self.has_pad else {}
        estimated |= {} if self.displacements is None else {"displacement": errors.displacement + rates[2]}
        if point.ndim == 1:
            out, inside, estimated = out[0], inside[0], {name: error[0] for name, error in estimated.items()}
        tip, force, touch, pad = out[..., :3], out[..., answer.FORCE], out[..., answer.TOUCH], out[..., -1]
        return Answer(
            tip=tip,
            contact_force=force,
            touch_distance=touch,
            pad_pressure=pad if self.has_pad else None,
            error=estimated,
            inside=inside,
        )

    def value_and_jacobian(self, parameters: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """`outputs` at one point, shape (5 or 6,), and their derivatives, shape (5 or 6, p); the fastest call.

        At touch itself, a kink, derivatives are those of the free side. Outside the sampled box they are zero across
        its walls. Where a form swings below zero just after touch, the force is held at zero but not its derivative, so
        that a solver finds where it rises.
        """
        return forms.answer(self.kernel, self._point(parameters))[:2]

    def jacobian(self, parameters: ArrayLike) -> np.ndarray:
        """The derivatives alone."""
        return self.value_and_jacobian(parameters)[1]

    def displacement(self, parameters: ArrayLike) -> np.ndarray:
        """Displacement of all nodes, shape (nodes, 3) [m]; outside the box, at the nearest point inside.

        Raises:
            ModelError: the wrong number of parameters, or a model without the field.
        """
        if self.displacements is None:
            raise ModelError("displacement must be in the scene's sampling.store, got a model of samples without it")
        (lower, upper), point, (free, contact) = self.limits, self._point(parameters), self._fields
        clamped = np.clip(np.where(np.isnan(point), lower, point), lower, upper)
        moved, touch = np.split(free.value_and_gradient(clamped[:-1])[0], [-1])
        path = float(touch[0] - clamped[-1])
        if point[-1] < touch[0] and path > 0:
            moved = moved + path * contact.value_and_gradient([*clamped[:-1], path / float(touch[0] - lower[-1])])[0]
        return moved.reshape(-1, 3)

    @cached_property
    def _fields(self) -> tuple[Separated, Separated]:
        """The forms of the displacement: that without contact, with the touch distance behind it, and what it adds."""
        assert self.displacements is not None
        _, free, contact = self.displacements
        return replace(self.free, modes=np.vstack([free, self.free.modes[-1]])), replace(self.contact, modes=contact)

    def truncated(self, tolerance: float) -> SeparatedModel:
        """The model with only the terms needed for a relative separation error [-], without the displacement.

        Its estimated errors grow by what the terms left out contribute.
        """
        (free, lost), (contact, less) = self.free.truncated(FREE_SHARE * tolerance), self.contact.truncated(tolerance)
        errors = replace(
            self.errors,
            tip=self.errors.tip + float(np.linalg.norm(lost[:3])),
            touch_distance=self.errors.touch_distance + float(lost[3]),
            contact=self.errors.contact + np.array([np.linalg.norm(less[:3]), less[3], 0.0, *less[4:]]),
        )
        shorter = replace(self, free=free, contact=contact, displacements=None, errors=errors)
        kept = ", ".join(f"{name} {shorter.terms[name]} of {count}" for name, count in self.terms.items())
        logger.info("a tolerance of %g keeps these products of one-dimensional functions: %s", tolerance, kept)
        return shorter if shorter.terms == self.terms else replace(shorter, accuracy={})

    def tables(self) -> list[Table | str]:
        """For people: its parts, its parameters, and its measured errors."""
        source = "samples of the finger before one object" if "specialised_from" in self.provenance else "states"
        moved = self.displacements
        nodes = "without the displacement field" if moved is None else f"displacement of {len(moved.nodes):,} nodes"
        terms = f"{sum(self.terms.values())} products in {len(self.terms)} forms"
        first = f"{self.scene['name']}: {terms} from {self.provenance['states']} {source}; {nodes}"
        parts: list[Table | str] = [first, parameters(self.parameters), *accuracy(self.accuracy)]
        return parts if self.accuracy else [*parts, NOT_MEASURED]

    def _repr_html_(self) -> str:
        return as_html(self.tables())

    def save(self, path: str | Path) -> None:
        """Write the model file (HDF5), see docs/format.md."""
        contents = model_file.contents(self)
        checked_file.save(Path(path), KIND, FORMAT, lambda file: checked_file.write_tree(file, contents))

    @classmethod
    def load(cls, path: str | Path, tolerance: float = 0.0) -> SeparatedModel:
        """Read a model file, with the terms needed for a relative separation error `tolerance` [-]; 0 keeps all.

        Raises:
            ModelError: no file, no model, a damaged one, or one of another format.
        """
        if not tolerance >= 0:
            raise ModelError(f"tolerance must be at least 0, got {tolerance}")
        whole = checked_file.load(Path(path), KIND, FORMAT, cls._of)
        return whole.truncated(tolerance) if tolerance > 0 else whole

    @classmethod
    def _of(cls, file: h5py.File) -> SeparatedModel:
        tree = model_file.checked(checked_file.read_tree(file))
        moved = tree.pop("displacement", None)
        return cls(
            **tree | {"errors": Errors(**tree["errors"])},
            displacements=None if moved is None else Field(**moved),
        )

    def _point(self, parameters: ArrayLike, most: int = 1) -> np.ndarray:
        names = ", ".join(self.names)
        try:
            point = np.ascontiguousarray(parameters, float)
        except (TypeError, ValueError):
            raise ModelError(f"parameters must be numbers, one for each of {names}, got {parameters!r}") from None
        if point.shape[-1:] != (len(self.parameters),) or point.ndim > most:
            raise ModelError(f"parameters must be {names} (in that order), got shape {point.shape}")
        return point
