"""The surrogate: named parameters in; tip, contact force and touch distance with units and error out."""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rom import limits, model_file
from rom.brief import brief
from rom.checked_file import ModelError
from rom.components import HEIGHTS, Components, Regime
from rom.fit import layout
from rom.native import EVALUATION, PickledByFields, answer
from rom.native.answer import Answer
from rom.native.forms import values
from rom.separated.separated_form import tables
from rom.table import NOT_MEASURED, Table, accuracy, as_html, parameters

logger = logging.getLogger(__name__)

SHIPPED = Path(__file__).with_name("plane.h5")  # made by `make plane`


@brief
@dataclass(frozen=True, kw_only=True)
class Surrogate(PickledByFields, Components):
    """A trained model of one scene.

    Example:
        >>> Surrogate.load().evaluate([60.0, 20.0, 0.012]).contact_force
    """

    def kernel_numbers(self) -> dict[str, Any]:
        """What a struct fingerfem_kernel holds or points to, by the names of rom/native/kernel.h."""
        lower, upper = self.limits
        sizes = np.ones((len(self.regimes), max((len(regime.sizes) for regime in self.regimes), default=0)))
        for r, regime in enumerate(self.regimes):
            sizes[r, : len(regime.sizes)] = regime.sizes
        return {
            "tables": tables([self.free, *(regime.form for regime in self.regimes)]),
            "parameters": len(lower),
            "has_obstacle": self.has_obstacle,
            "has_pad": self.has_pad,
            "regimes": len(self.regimes),
            "most_conditions": sizes.shape[1],
            "lookup_cells": round(len(self.regime_lookup) ** (1 / len(self.parameters))),
            "lower": lower,
            "upper": upper,
            "corners": [regime.corner for regime in self.regimes],
            "begins": [regime.begins for regime in self.regimes],
            "sizes": sizes,
            "lookup": self.regime_lookup,
            "possible": self.possible_regimes,
            "nearest": self.coordinates.nearest,
            "softening": self.coordinates.soft,
        }

    @cached_property
    def kernel(self) -> Any:
        """The arrays for the compiled answer, a struct fingerfem_kernel.

        Raises:
            ModelError: a model beyond what compiled code holds.
        """
        limits.check_sizes(self)
        return EVALUATION.struct("fingerfem_kernel", **self.kernel_numbers())

    @property
    def native(self) -> dict[str, Any]:
        """What compiled controllers ask: the arrays, how its errors in contact grow, and what its mesh adds."""
        contact = self.errors.contact
        known = {"kernel": self.kernel, "rates": contact, "columns": contact.shape[1], "margin": self.errors.margin}
        mesh = self.errors.mesh
        return known | ({} if mesh is None else {"mesh": np.array([*mesh.contact_force, *mesh.pad_pressure])})

    def outputs(self, points: np.ndarray) -> np.ndarray:
        """Tip [m], contact force [N], touch distance [m], and pad pressure [Pa] if known, shape (n, 5 or 6)."""
        return answer.answers(self.kernel, points)[0]

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

    def evaluate(self, parameters: ArrayLike) -> Answer:
        """Tip, contact force and touch distance at tensions [N] and d [m], shape (p,) or (n, p).

        Raises:
            ModelError: the wrong number of parameters.
        """
        point = self._point(parameters, most=2)
        out, inside, _ = answer.answers(self.kernel, np.atleast_2d(point))
        parts = self._error_parts(np.atleast_2d(point), out)
        if point.ndim == 1:
            out, inside = out[0], inside[0]
            parts = {kind: {name: error[0] for name, error in part.items()} for kind, part in parts.items()}
        return Answer(
            tip=out[..., :3],
            contact_force=out[..., answer.FORCE],
            touch_distance=out[..., answer.TOUCH],
            pad_pressure=out[..., answer.PAD] if self.has_pad else None,
            error={name: sum(part[name] for part in parts.values()) for name in parts["surrogate"]},
            inside=inside,
            error_parts=parts,
        )

    def _error_parts(self, points: np.ndarray, out: np.ndarray) -> dict[str, dict[str, np.ndarray]]:
        """The surrogate's part of its errors at points, shape (n, p), and the mesh's, if that is known; shapes (n,)."""
        touch, errors = out[:, answer.TOUCH], self.errors
        contact_errors = answer.contact_errors(self.kernel, errors.contact, errors.margin, points, touch)
        own = {
            "tip": errors.tip + contact_errors[:, 0],
            "contact_force": contact_errors[:, 1],
            "touch_distance": np.full_like(touch, errors.touch_distance),
        }
        if self.has_pad:
            own["pad_pressure"] = contact_errors[:, 3]
        if self.has_field:
            own["displacement"] = errors.displacement + contact_errors[:, 2]
        if errors.mesh is None:
            return {"surrogate": own}
        mesh = errors.mesh.of(self.kernel, points, out)
        return {"surrogate": own, "mesh": {name: mesh[name] for name in own}}

    def free_values(self, tensions: np.ndarray) -> np.ndarray:
        """Tip and heights in free space [m], shape (n, 3 + heights), at tensions, shape (n, tensions) [N]."""
        return values(self.free.tables, 0, np.asarray(tensions, float))

    def value_and_jacobian(self, parameters: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Tip x, y, z [m], contact force [N], touch distance [m], shape (5,), and `jacobian`; the fastest call.

        Models that know the pad have a sixth output, its pressure [Pa].
        """
        out, jacobian, _ = answer.answer(self.kernel, self._point(parameters))
        return out, jacobian

    def truncated(self, tolerance: float) -> Surrogate:
        """The model with only the terms needed for a relative separation error [-]; its errors grow by what is lost."""
        errors, contact = self.errors, self.errors.contact.copy()
        # Contact begins where the heights say: what they lost would not grow from zero as the rates of contact do.
        free, lost = self.free.truncated(HEIGHTS * tolerance)
        regimes, fields = [], []
        for r, regime in enumerate(self.regimes):
            form, less = regime.form.truncated(tolerance)
            regimes.append(replace(regime, form=form))
            path = 1.0 if regime.begins else self.coordinates.soft
            contact[self.regime_lookup == r, :2] += (
                np.array([np.linalg.norm(less[layout.TIP]), less[layout.FORCE]]) / path
            )
        moved = self.displacements
        displacement_lost = 0.0
        if moved is not None:
            kept, gone = moved.free.truncated(tolerance)
            displacement_lost = float(np.linalg.norm(gone)) / np.sqrt(len(self.nodes))
            for r, form in enumerate(moved.regimes):
                fields.append(form.truncated(tolerance)[0])
                less = form.truncated(tolerance)[1]
                path = 1.0 if self.regimes[r].begins else self.coordinates.soft
                contact[self.regime_lookup == r, 2] += np.linalg.norm(less) / np.sqrt(len(self.nodes)) / path
            moved = replace(moved, free=kept, regimes=fields)
        found = replace(
            self,
            free=free,
            regimes=regimes,
            displacements=moved,
            errors=replace(
                errors,
                tip=errors.tip + float(np.linalg.norm(lost[layout.TIP])),
                touch_distance=errors.touch_distance + float(lost[layout.HEIGHTS].max(initial=0.0)),
                displacement=errors.displacement + displacement_lost,
                contact=contact,
            ),
        )
        whole, fewer = self.terms, found.terms
        if fewer != whole:
            found = replace(found, accuracy={})
        kept_terms = ", ".join(f"{name} {fewer[name]} of {count}" for name, count in whole.items())
        logger.info("a tolerance of %g keeps these products of one-dimensional functions: %s", tolerance, kept_terms)
        return found

    @property
    def bytes(self) -> int:
        """Size of its numbers, without the nodes of the mesh [B]."""
        forms = [(form.modes, *form.factors, *form.slopes) for form in self.forms.values()]
        lookup = self.regime_lookup.astype(np.uint8), self.possible_regimes
        arrays = [*sum(forms, ()), *lookup, self.errors.contact.astype(np.float32)]
        if self.displacements is not None:
            bases = (self.displacements.free_basis, self.displacements.contact_basis)
            arrays += [basis for basis in bases if basis is not None]
        return int(sum(array.nbytes for array in arrays))

    @property
    def terms(self) -> dict[str, int]:
        """Number of terms of every form."""
        return {name: form.terms for name, form in self.forms.items()}

    def regime(self, parameters: ArrayLike) -> Regime | None:
        """The contact regime at a point, shape (p,) [N, m]; None without contact.

        Raises:
            ModelError: the wrong number of parameters.
        """
        r = int(answer.answers(self.kernel, self._point(parameters)[None])[2][0])
        return None if r < 0 else self.regimes[r]

    def jacobian(self, parameters: ArrayLike) -> np.ndarray:
        """Derivatives of tip x, y, z [m], contact force [N] and touch distance [m], shape (5, p), by the parameters.

        Models that know the pad have a sixth row, its pressure [Pa].
        At touch itself, a kink, they are those of the free side. Outside the trained box they are zero across its
        walls. Where a fit swings below zero just after touch, the force is held at zero but not its derivative, so
        that a solver finds where it rises.
        """
        return answer.answer(self.kernel, self._point(parameters))[1]

    def displacement(self, parameters: ArrayLike) -> np.ndarray:
        """Displacement of all nodes, shape (nodes, 3) [m].

        Outside the trained box it is that of the nearest point inside; `evaluate` says which points are.

        Raises:
            ModelError: the wrong number of parameters, or a model without the field.
        """
        if self.displacements is None:
            raise ModelError("displacement must be in the scene's sampling.store to be known, got a model without it")
        lower, upper = self.limits
        point = self._point(parameters)
        held = np.clip(np.where(np.isnan(point), lower, point), lower, upper)
        tensions = held[:-1] if self.has_obstacle else held
        moved = self.displacements.free_basis @ self.displacements.free.value(tensions).astype(np.float32)
        if self.has_obstacle:
            r = answer.answers(self.kernel, point[None])[2][0]
            if r >= 0:
                height = self.free.value(tensions)[layout.height(self.regimes[r].corner)]
                coordinates = self.coordinates.of(held[None], np.array([height]))[0]
                amounts = self.displacements.regimes[r].value(coordinates)
                if self.regimes[r].begins:
                    amounts *= height - held[-1]
                assert self.displacements.contact_basis is not None
                moved = moved + self.displacements.contact_basis @ amounts.astype(np.float32)
        return moved.astype(float).reshape(-1, 3)

    def tables(self) -> list[Table | str]:
        """For people: what it is made of, its parameters, and what it was measured to err by."""
        made, fields = self.provenance, f"displacement of {len(self.nodes):,} nodes"
        terms = f"{sum(self.terms.values())} products in {len(self.terms)} forms"
        source = "samples of the finger before one object" if "specialised_from" in made else "states"
        first = f"{self.scene['name']}: {terms} from {made['states']} {source}; "
        parts: list[Table | str] = [first + (fields if self.has_field else "without the displacement field")]
        parts += [parameters(self.parameters), *accuracy(self.accuracy)]
        if not self.accuracy:
            parts.append(NOT_MEASURED)
        if "against_finer_mesh" in self.accuracy:
            mesh = " x ".join(map(str, made["mesh_error"]["cells"])) + f" cells of order {made['mesh_error']['order']}"
            parts += accuracy(self.accuracy["against_finer_mesh"], f"mesh and surrogate together, against {mesh}")
        return parts

    def _repr_html_(self) -> str:
        return as_html(self.tables())

    def save(self, path: str | Path) -> None:
        """Write the model file (HDF5), see rom.model_file and docs/format.md."""
        model_file.save(self, Path(path))

    @classmethod
    def load(cls, path: str | Path | None = None, tolerance: float = 0.0) -> Surrogate:
        """Read a model file.

        Args:
            path: the file; that of the finger that comes with the package, if left out (scenes/standard.toml).
            tolerance: keep only the terms needed for this relative separation error [-]; 0 keeps all. What was kept is
                logged, and is in `terms`; the errors grow by what the terms left out were worth.

        Raises:
            ModelError: no file, no model, a damaged one, or one of another format.
        """
        if not tolerance >= 0:
            raise ModelError(f"tolerance must be at least 0, got {tolerance}")
        found = cls(**model_file.load(Path(path or SHIPPED)))
        return found.truncated(tolerance) if tolerance > 0 else found
