"""A separated model: tensions and the object's distance in; tip, contact force and touch distance with errors out.

    u(F, d) = u_0(F) + p v(F, s),   p = D(F) - d,   s = p / (D(F) - d_min + soft),

u_0, D and v each a sum of products of one-dimensional functions (`rom.separated.separated_form`).
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import h5py
import numpy as np
from numpy.typing import ArrayLike

from rom import checked_file
from rom.brief import brief
from rom.checked_file import ModelError
from rom.native import EVALUATION, PickledByFields, answer
from rom.native.answer import Answer
from rom.separated import limits, model_file
from rom.separated.parts import ContactCoordinates, Errors, Field
from rom.separated.separated_form import Separated, tables
from rom.table import NOT_MEASURED, Table, accuracy, as_html, parameters

logger = logging.getLogger(__name__)

FREE_SHARE = 0.01  # of a tolerance, for the free form: contact begins at its touch distance [-]
TOUCH = 3  # column of the touch distance in the free form


@brief
@dataclass(frozen=True, kw_only=True)
class SeparatedModel(PickledByFields):
    """A finger before one object, as sums of products of one-dimensional functions.

    Attributes:
        parameters: name, unit, lower and upper of each parameter, tensions first, then d.
        free: tip [m] and touch distance [m] without contact, by the tensions.
        contact: what contact adds per length of its path: tip [-], contact force [N/m] and, if the model has it, pad
            pressure [Pa/m]; by tensions and s.
        coordinates: the contact-aligned ones.
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

    parameters: list[dict[str, Any]]
    free: Separated
    contact: Separated
    coordinates: ContactCoordinates
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
        return [parameter["name"] for parameter in self.parameters]

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
        return (
            np.array([parameter["lower"] for parameter in self.parameters], float),
            np.array([parameter["upper"] for parameter in self.parameters], float),
        )

    @property
    def forms(self) -> dict[str, Separated]:
        """Its separated forms by name."""
        return {"free": self.free, "contact": self.contact}

    @property
    def terms(self) -> dict[str, int]:
        """Number of terms of every form."""
        return {name: form.terms for name, form in self.forms.items()}

    @property
    def bytes(self) -> int:
        """Size of its forms and estimated errors [B]."""
        forms = [(form.modes, *form.factors, *form.slopes) for form in self.forms.values()]
        arrays = [*sum(forms, ()), self.answered, self.errors.contact.astype(np.float32)]
        return int(sum(array.nbytes for array in arrays))

    def kernel_numbers(self) -> dict[str, Any]:
        """The fields of a struct fingerfem_kernel, by the names of rom/native/kernel.h."""
        lower, upper = self.limits
        return {
            "tables": tables([self.free, self.contact]),
            "parameters": len(lower),
            "has_pad": self.has_pad,
            "cells": self.cells,
            "lower": lower,
            "upper": upper,
            "answered": self.answered.astype(np.uint8),
            "nearest": self.coordinates.nearest,
            "softening": self.coordinates.soft,
        }

    @cached_property
    def kernel(self) -> Any:
        """The arrays for the compiled answer, a struct fingerfem_kernel.

        Raises:
            ModelError: a model beyond the limits of compiled code.
        """
        limits.check_sizes(self)
        return EVALUATION.struct("fingerfem_kernel", **self.kernel_numbers())

    @property
    def native(self) -> dict[str, Any]:
        """The fields that compiled controllers read: the arrays, and the rates of errors in contact."""
        contact = self.errors.contact
        return {"kernel": self.kernel, "rates": contact, "columns": contact.shape[1], "margin": self.errors.margin}

    def outputs(self, points: np.ndarray) -> np.ndarray:
        """Tip [m], contact force [N], touch distance [m], pad pressure [Pa] if the model has it, shape (n, 5 or 6)."""
        return answer.answers(self.kernel, points)[0]

    def evaluate(self, parameters: ArrayLike) -> Answer:
        """Tip, contact force and touch distance at tensions [N] and d [m], shape (p,) or (n, p).

        Raises:
            ModelError: the wrong number of parameters.
        """
        point = self._point(parameters, most=2)
        points = np.atleast_2d(point)
        out, inside = answer.answers(self.kernel, points)
        errors = self._estimated(points, out[:, answer.TOUCH])
        if point.ndim == 1:
            out, inside, errors = out[0], inside[0], {name: error[0] for name, error in errors.items()}
        return Answer(
            tip=out[..., :3],
            contact_force=out[..., answer.FORCE],
            touch_distance=out[..., answer.TOUCH],
            pad_pressure=out[..., answer.PAD] if self.has_pad else None,
            error=errors,
            inside=inside,
        )

    def value_and_jacobian(self, parameters: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Tip x, y, z [m], contact force [N], touch distance [m], shape (5,), and `jacobian`; the fastest call.

        With a pad there is a sixth output, its pressure [Pa].
        """
        out, jacobian, _ = answer.answer(self.kernel, self._point(parameters))
        return out, jacobian

    def jacobian(self, parameters: ArrayLike) -> np.ndarray:
        """Derivatives of tip x, y, z [m], contact force [N] and touch distance [m], shape (5, p), by the parameters.

        With a pad there is a sixth row, its pressure [Pa]. At touch itself, a kink, they are those of the free side.
        Outside the sampled box they are zero across its walls. Where a form swings below zero just after touch, the
        force is held at zero but not its derivative, so that a solver finds where it rises.
        """
        return answer.answer(self.kernel, self._point(parameters))[1]

    def displacement(self, parameters: ArrayLike) -> np.ndarray:
        """Displacement of all nodes, shape (nodes, 3) [m]; outside the box, at the nearest point inside.

        Raises:
            ModelError: the wrong number of parameters, or a model without the field.
        """
        if self.displacements is None:
            raise ModelError("displacement must be in the scene's sampling.store, got a model of samples without it")
        lower, upper = self.limits
        point = self._point(parameters)
        held = np.clip(np.where(np.isnan(point), lower, point), lower, upper)
        moved, tensions = self.displacements, held[:-1]
        amounts = replace(self.free, modes=moved.free).value(tensions)
        touch = self.free.value(tensions)[TOUCH]
        if point[-1] < touch:
            coordinates = self.coordinates.of(held[None], np.array([touch]))[0]
            added = replace(self.contact, modes=moved.contact).value(coordinates)
            amounts = amounts + max(touch - held[-1], 0.0) * added
        return np.asarray((moved.basis @ amounts.astype(np.float32)).astype(float).reshape(-1, 3))

    def truncated(self, tolerance: float) -> SeparatedModel:
        """The model with only the terms needed for a relative separation error [-], without the displacement.

        Its estimated errors grow by what the terms left out contribute.
        """
        free, lost = self.free.truncated(FREE_SHARE * tolerance)
        contact, less = self.contact.truncated(tolerance)
        errors, rates = self.errors, self.errors.contact.copy()
        rates[:, 0] += np.linalg.norm(less[:3])
        rates[:, 1] += less[3]
        if self.has_pad:
            rates[:, 3] += less[4]
        errors = replace(
            errors,
            tip=errors.tip + float(np.linalg.norm(lost[:3])),
            touch_distance=errors.touch_distance + float(lost[TOUCH]),
            contact=rates,
        )
        shorter = replace(self, free=free, contact=contact, displacements=None, errors=errors)
        whole, fewer = self.terms, shorter.terms
        kept = ", ".join(f"{name} {fewer[name]} of {count}" for name, count in whole.items())
        logger.info("a tolerance of %g keeps these products of one-dimensional functions: %s", tolerance, kept)
        return shorter if fewer == whole else replace(shorter, accuracy={})

    def tables(self) -> list[Table | str]:
        """For people: its parts, its parameters, and its measured errors."""
        made = self.provenance
        source = "samples of the finger before one object" if "specialised_from" in made else "states"
        terms = f"{sum(self.terms.values())} products in {len(self.terms)} forms"
        moved = self.displacements
        nodes = "without the displacement field" if moved is None else f"displacement of {len(moved.nodes):,} nodes"
        first = f"{self.scene['name']}: {terms} from {made['states']} {source}; {nodes}"
        parts: list[Table | str] = [first, parameters(self.parameters), *accuracy(self.accuracy)]
        return parts if self.accuracy else [*parts, NOT_MEASURED]

    def _repr_html_(self) -> str:
        return as_html(self.tables())

    def save(self, path: str | Path) -> None:
        """Write the model file (HDF5), see rom.separated.model_file and docs/format.md."""
        checked_file.save(Path(path), model_file.KIND, model_file.FORMAT, lambda file: model_file.write(self, file))

    @classmethod
    def load(cls, path: str | Path, tolerance: float = 0.0) -> SeparatedModel:
        """Read a model file.

        Args:
            path: the file.
            tolerance: keep only the terms needed for this relative separation error [-]; 0 keeps all.

        Raises:
            ModelError: no file, no model, a damaged one, or one of another format.
        """
        if not tolerance >= 0:
            raise ModelError(f"tolerance must be at least 0, got {tolerance}")
        whole = checked_file.load(Path(path), model_file.KIND, model_file.FORMAT, cls._of)
        return whole.truncated(tolerance) if tolerance > 0 else whole

    @classmethod
    def _of(cls, file: h5py.File) -> SeparatedModel:
        model = cls(**model_file.fields(file))
        limits.check(model)
        return model

    def _point(self, parameters: ArrayLike, most: int = 1) -> np.ndarray:
        try:
            point = np.ascontiguousarray(parameters, float)
        except (TypeError, ValueError):
            raise ModelError(
                f"parameters must be numbers, one for each of {', '.join(self.names)}, got {parameters!r}"
            ) from None
        if point.shape[-1:] != (len(self.parameters),) or point.ndim > most:
            raise ModelError(f"parameters must be {', '.join(self.names)} (in that order), got shape {point.shape}")
        return point

    def _estimated(self, points: np.ndarray, touch: np.ndarray) -> dict[str, np.ndarray]:
        """Estimated errors at points, shape (n, p), with touch distances, shape (n,), by quantity, shapes (n,)."""
        errors = self.errors
        contact = answer.contact_errors(self.kernel, errors.contact, errors.margin, points, touch)
        found = {
            "tip": errors.tip + contact[:, 0],
            "contact_force": contact[:, 1],
            "touch_distance": np.full_like(touch, errors.touch_distance),
        }
        if self.has_pad:
            found["pad_pressure"] = contact[:, 3]
        if self.displacements is not None:
            found["displacement"] = errors.displacement + contact[:, 2]
        return found
