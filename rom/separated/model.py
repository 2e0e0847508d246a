"""A separated model: tensions and the object's distance in; tip, contact force and touch distance with errors out.

`rom.separated.tabulated` has its formula, and makes it of samples.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from rom.answer import FORCE, TOUCH, Answer
from rom.brief import brief
from rom.console.table import NOT_MEASURED, Table, accuracy, parameters
from rom.files import checked_file
from rom.files.checked_file import ModelError
from rom.native import LIBRARY, PickledByFields, forms
from rom.parameter import Parameter, joined
from rom.parametric_model import ParametricModel
from rom.separated import model_file
from rom.separated.errors import COLUMNS, Errors
from rom.separated.form import Separated, tables

logger = logging.getLogger(__name__)
KIND, FORMAT = "fingerfem separated model", 2
FREE_SHARE = 0.01  # of a tolerance, for the free form: contact begins at its touch distance [-]


@brief
@dataclass(frozen=True, kw_only=True)
class SeparatedModel(ParametricModel, PickledByFields):
    """A finger before one object, as sums of products of one-dimensional functions.

    Attributes:
        parameters: tensions first, then d.
        free: tip [m] and touch distance [m] without contact, by the tensions; its field is the nodes' displacement [m].
        contact: what contact adds per length of its path: tip [-], contact force [N/m] and, if the model has it, pad
            pressure [Pa/m]; by tensions and s. Its field is the nodes' displacement [-].
        errors: the estimated ones.
        nodes: at rest, shape (nodes, 3) [m]; None if the samples had no displacement.
        scene: the sampled finger's.
        accuracy: error by quantity against what the samples are from; empty if it is not measured.
        provenance: what the samples are from.

    Example:
        >>> specialise(TouchedSegment.load()).evaluate([60.0, 20.0, 0.012]).contact_force  # doctest: +SKIP
    """

    parameters: list[Parameter]
    free: Separated
    contact: Separated
    errors: Errors = field(repr=False)
    nodes: np.ndarray | None = field(repr=False, default=None)
    scene: dict[str, Any] = field(repr=False)
    accuracy: dict[str, dict[str, Any]]
    provenance: dict[str, Any]
    has_obstacle: ClassVar[bool] = True

    @property
    def has_pad(self) -> bool:
        """True if the model has the pad's pressure."""
        return len(self.contact.modes) > FORCE + 1

    @property
    def terms(self) -> dict[str, int]:
        """Number of terms of every form."""
        return {"free": self.free.terms, "contact": self.contact.terms}

    @property
    def bytes(self) -> int:
        """Size of its forms and estimated errors [B]."""
        numbers = [part for form in (self.free, self.contact) for part in (form.modes, *form.functions)]
        return sum(part.nbytes for part in [*numbers, self.errors.answered, self.errors.contact.astype(np.float32)])

    @cached_property
    def kernel(self) -> Any:
        """The arrays for the compiled answer, a struct fingerfem_kernel."""
        lower, upper = self.limits
        return LIBRARY.struct(
            "fingerfem_kernel",
            tables=tables([self.free, self.contact]),
            parameters=len(lower),
            has_pad=self.has_pad,
            cells=len(self.errors.contact),
            lower=lower,
            upper=upper,
            answered=self.errors.answered.astype(np.uint8),
        )

    @property
    def native(self) -> dict[str, Any]:
        """The fields that compiled controllers read: the arrays, and the rates of errors in contact."""
        contact = self.errors.contact
        return {"kernel": self.kernel, "rates": contact, "columns": contact.shape[-1], "margin": self.errors.margin}

    def outputs(self, points: np.ndarray) -> np.ndarray:
        """Tip [m], contact force [N], touch distance [m], pad pressure [Pa] if the model has it, shape (n, 5 or 6)."""
        return forms.answers(self.kernel, points)[0]

    def evaluate(self, parameters: ArrayLike, d: ArrayLike | None = None) -> Answer:
        """Tip, contact force and touch distance at tensions [N] and d [m], shape (p,) or (n, p).

        If d is given, the parameters are tensions alone, see `rom.parameter.joined`.

        Raises:
            ModelError: the wrong number of parameters.
        """
        point, errors = self.checked(parameters if d is None else joined(parameters, d)), self.errors
        points = np.atleast_2d(point)
        out, inside = forms.answers(self.kernel, points)
        rates = forms.contact_errors(self.kernel, errors.contact, errors.margin, points, out[:, TOUCH])
        error = dict(zip(COLUMNS, (errors.alone + rates).T, strict=False))
        error["touch_distance"] = np.full(len(points), errors.touch_distance)
        if self.nodes is None:
            del error["displacement"]
        if point.ndim == 1:
            out, inside, error = out[0], inside[0], {name: one[0] for name, one in error.items()}
        tip, force, touch = out[..., :FORCE], out[..., FORCE], out[..., TOUCH]
        pad = out[..., -1] if self.has_pad else None
        return Answer(tip=tip, contact_force=force, touch_distance=touch, pad_pressure=pad, error=error, inside=inside)

    def value_and_jacobian(self, parameters: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """`outputs` at one point, shape (5 or 6,), and their derivatives, shape (5 or 6, p); the fastest call.

        At touch itself, a kink, derivatives are those of the free side; across walls of the sampled box they are zero.
        If a form swings below zero just after touch, the force is clamped to zero, but not its derivative.
        """
        return forms.answer(self.kernel, self.checked(parameters, most=1))[:2]

    def displacement(self, parameters: ArrayLike) -> np.ndarray:
        """Displacement of all nodes, shape (nodes, 3) [m]; outside the box, at the nearest point inside.

        Raises:
            ModelError: the wrong number of parameters, or a model without the field.
        """
        if self.nodes is None:
            raise ModelError("displacement must be in the scene's sampling.store, got a model of samples without it")
        (lower, upper), point = self.limits, self.checked(parameters, most=1)
        tensions, d = np.split(np.clip(np.where(np.isnan(point), lower, point), lower, upper)[None], [-1], axis=1)
        touch = self.outputs(point[None])[0, TOUCH]
        moved, path = forms.values(self._fields, 0, tensions), touch - d
        if point[-1] < touch and path > 0:
            share = path / (touch - lower[-1])
            moved += path * forms.values(self._fields, 1, np.hstack([tensions, share]))
        return moved.reshape(-1, 3)

    @cached_property
    def _fields(self) -> Any:
        """The two forms of the displacement, a struct fingerfem_tables."""
        fields = [replace(form, modes=form.field) for form in (self.free, self.contact)]
        return LIBRARY.struct("fingerfem_tables", **tables(fields))

    def truncated(self, tolerance: float) -> SeparatedModel:
        """The model with only the terms needed for a relative separation error [-], without the displacement.

        Its estimated errors grow by what the terms left out contribute.
        """
        (free, lost), (contact, less) = self.free.truncated(FREE_SHARE * tolerance), self.contact.truncated(tolerance)
        tip, touch = self.errors.tip + float(np.linalg.norm(lost[:3])), self.errors.touch_distance + float(lost[3])
        rates = self.errors.contact + np.array([np.linalg.norm(less[:3]), less[3], 0.0, *less[4:]])
        errors = replace(self.errors, tip=tip, touch_distance=touch, contact=rates)
        shorter = replace(self, free=free, contact=contact, nodes=None, errors=errors)
        kept = ", ".join(f"{name} {shorter.terms[name]} of {count}" for name, count in self.terms.items())
        logger.info("a tolerance of %g keeps these products of one-dimensional functions: %s", tolerance, kept)
        return shorter if shorter.terms == self.terms else replace(shorter, accuracy={})

    def tables(self) -> list[Table | str]:
        """Tables for people: the model's parts, its parameters, and its measured errors."""
        source = "samples of the finger before one object" if "specialised_from" in self.provenance else "states"
        nodes = "without the displacement field" if self.nodes is None else f"displacement of {len(self.nodes):,} nodes"
        terms = f"{sum(self.terms.values())} products in {len(self.terms)} forms"
        first = f"{self.scene['name']}: {terms} from {self.provenance['states']} {source}; {nodes}"
        measured = accuracy(self.accuracy)
        return [first, parameters(self.parameters), *(measured if measured else [NOT_MEASURED])]

    def save(self, path: str | Path) -> None:
        """Write the model file (HDF5), see docs/format.md."""
        tree = model_file.contents(self)
        checked_file.save(Path(path), KIND, FORMAT, lambda file: checked_file.write_tree(file, tree))

    @classmethod
    def load(cls, path: str | Path, tolerance: float = 0.0) -> SeparatedModel:
        """Read a model file, with the terms needed for a relative separation error `tolerance` [-]; 0 keeps all.

        Raises:
            ModelError: no file, no model, a damaged one, or one of another format.
        """
        if not tolerance >= 0:
            raise ModelError(f"tolerance must be at least 0, got {tolerance}")
        whole = cls(**checked_file.load(Path(path), KIND, FORMAT, model_file.read))
        return whole.truncated(tolerance) if tolerance > 0 else whole
