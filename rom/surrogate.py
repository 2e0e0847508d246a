"""The surrogate: named parameters in; tip, contact force and touch distance with units and error out."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import ArrayLike

from rom import chart as contact_chart
from rom.kernel import Kernel, answer, answers
from rom.separated import Separated, evaluate

FORMAT = 2
FORMS = ("free", "free_displacement", "onset", "contact", "contact_displacement")


class ModelError(ValueError):
    """A model file that cannot be read, or parameters of the wrong shape: one line."""


@dataclass(frozen=True, kw_only=True)
class Answer:
    """What the surrogate says at one point, shapes without n, or at n points.

    Attributes:
        tip: displacement of the tip plate's centre, shape (3,) or (n, 3) [m].
        contact_force: [N], shape () or (n,); zero before touch and in scenes without an obstacle.
        touch_distance: how far the free finger reaches towards the plane [m], shape () or (n,); nan without one.
        error: bound that 95 % of held-out states kept, by quantity in its unit; nan if the model was not checked with
            the terms it has. Of the contact force it is a share of the force, so 0 before touch; how sure touch itself
            is, the error of the touch distance says.
        inside: whether the point lies in the trained box (a plane that is not touched may stand anywhere, d = inf too).
            Outside, the answer is that of the nearest point inside, and nothing says how far it is from the truth.
    """

    tip: np.ndarray
    contact_force: Any
    touch_distance: Any
    error: Mapping[str, Any]
    inside: Any


@dataclass(frozen=True, kw_only=True)
class Surrogate:
    """A trained model of one scene.

    Attributes:
        parameters: name, unit, lower and upper of each parameter, tensions first, then d.
        forms: separated forms by name, see FORMS; only those the scene needs.
        lead: index of the lead tension.
        nodes: the finger's nodes at rest, shape (nodes, 3) [m].
        scene: the scene it was trained on.
        accuracy: error by quantity on held-out states, see rom.errors.check; empty if not checked with these terms.
        provenance: versions, states, fingerprint.
    """

    parameters: list[dict[str, Any]]
    forms: Mapping[str, Separated]
    lead: int
    nodes: np.ndarray = field(repr=False)
    scene: dict[str, Any] = field(repr=False)
    accuracy: dict[str, dict[str, float]]
    provenance: dict[str, Any]

    @property
    def names(self) -> list[str]:
        """Names of the parameters in order."""
        return [parameter["name"] for parameter in self.parameters]

    @property
    def has_obstacle(self) -> bool:
        """Whether the last parameter is the plane's distance."""
        return self.names[-1] == "d"

    @property
    def has_field(self) -> bool:
        """Whether it knows the displacement of all nodes."""
        return "free_displacement" in self.forms

    @cached_property
    def limits(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper end of the trained box, shapes (p,)."""
        return (
            np.array([parameter["lower"] for parameter in self.parameters], float),
            np.array([parameter["upper"] for parameter in self.parameters], float),
        )

    @cached_property
    def kernel(self) -> Kernel:
        """The arrays for the compiled `answer`."""
        lower, upper = self.limits
        free = self.forms["free"].packed
        if not self.has_obstacle:
            return Kernel(free, free, contact_chart.Chart(self.lead, 0.0, 0.0, free), lower, upper, False)
        chart = contact_chart.Chart(self.lead, float(upper[self.lead]), float(lower[-1]), self.forms["onset"].packed)
        return Kernel(free, self.forms["contact"].packed, chart, lower, upper, True)

    def _point(self, parameters: ArrayLike, most: int = 1) -> np.ndarray:
        point = np.ascontiguousarray(parameters, float)
        if point.shape[-1:] != (len(self.parameters),) or point.ndim > most:
            raise ModelError(f"parameters must be {', '.join(self.names)} (in that order), got shape {point.shape}")
        return point

    def evaluate(self, parameters: ArrayLike) -> Answer:
        """Tip, contact force and touch distance at tensions [N] and d [m], shape (p,) or (n, p).

        Raises:
            ModelError: the wrong number of parameters.
        """
        point = self._point(parameters, most=2)
        out, inside = answers(self.kernel, np.atleast_2d(point))
        if point.ndim == 1:
            out, inside = out[0], inside[0]
        force = out[..., 3]
        error = {
            "tip": np.full_like(force, self._bound("tip", 0.0)),
            "contact_force": self._bound("contact_force", force),
            "touch_distance": np.full_like(force, self._bound("touch_distance", 0.0)),
        }
        return Answer(tip=out[..., :3], contact_force=force, touch_distance=out[..., 4], error=error, inside=inside)

    def _bound(self, quantity: str, value: Any) -> Any:
        measured = self.accuracy.get(quantity, {})
        if "p95" not in measured:
            return np.nan * np.ones_like(value)
        if quantity == "contact_force":
            return measured["p95"] * np.abs(value) * (np.asarray(value) > 0)
        return measured["p95_absolute"]

    def jacobian(self, parameters: ArrayLike) -> np.ndarray:
        """Derivatives of tip x, y, z [m], contact force [N] and touch distance [m], shape (5, p), by the parameters.

        At touch itself, a kink, they are those of the free side. Outside the trained box they are zero across its
        walls. Where a spline swings below zero just after touch, the force is held at zero but not its derivative, so
        that a solver finds its way.
        """
        return answer(self.kernel, self._point(parameters))[1]

    def displacement(self, parameters: ArrayLike) -> np.ndarray:
        """Displacement of all nodes, shape (nodes, 3) [m].

        Outside the trained box it is that of the nearest point inside; `evaluate` says which points are.

        Raises:
            ModelError: the wrong number of parameters, or a model without the field.
        """
        if not self.has_field:
            raise ModelError("displacement must be in the scene's sampling.store to be known, got a model without it")
        lower, upper = self.limits
        point = self._point(parameters)
        held = np.clip(np.where(np.isnan(point), lower, point), lower, upper)
        tensions = held[:-1] if self.has_obstacle else held
        field = self.forms["free_displacement"].value(tensions)
        if self.has_obstacle:
            value, gradient = evaluate(self.kernel.free, tensions)
            first = 3 + int(np.argmax(value[3:]))
            if held[-1] < value[first] and not point[-1] >= value[first]:  # an untouched plane may stand anywhere
                where, _ = contact_chart.coordinates(self.kernel.chart, held, value[first], gradient[first])
                field = field + self.forms["contact_displacement"].value(where)
        return field.reshape(-1, 3)

    # -- file --------------------------------------------------------------------------------------------------------

    def save(self, path: str | Path) -> None:
        """Write the model file (HDF5), beside and renamed."""
        path = Path(path)
        with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.name}.") as beside:
            self._write(Path(beside) / path.name)
            (Path(beside) / path.name).replace(path)

    def _write(self, path: Path) -> None:
        with h5py.File(path, "w") as file:
            file.attrs["format"] = FORMAT
            for name in ("parameters", "scene", "accuracy", "provenance"):
                file.attrs[name] = json.dumps(getattr(self, name))
            file.attrs["lead"] = self.lead
            file["nodes"] = self.nodes.astype(np.float32)
            file["nodes"].attrs["unit"] = "m"
            for name, form in self.forms.items():
                group = file.create_group(name)
                group["modes"] = form.modes.astype(np.float32) if name.endswith("displacement") else form.modes
                group["modes"].attrs["unit"] = self._units(name)
                group["errors"] = form.errors
                group.attrs["kinds"] = list(form.kinds)
                for a, (nodes, factor) in enumerate(zip(form.nodes, form.factors, strict=True)):
                    group[f"nodes_{a}"], group[f"factor_{a}"] = nodes, factor
                    group[f"nodes_{a}"].attrs["axis"], group[f"nodes_{a}"].attrs["unit"] = self._axes(name)[a]

    def _axes(self, form: str) -> list[tuple[str, str]]:
        """Name and unit of a form's axes."""
        tensions = [(parameter["name"], "N") for parameter in self.parameters if parameter["name"] != "d"]
        if form == "onset":
            return [axis for k, axis in enumerate(tensions) if k != self.lead]
        if form.startswith("contact"):
            tensions[self.lead] = (f"xi of {tensions[self.lead][0]}", "-")
            return [*tensions, ("s", "-")]
        return tensions

    def _units(self, form: str) -> str:
        """Unit of a form's modes; component by component where they differ."""
        return {"onset": "N", "contact": "m, m, m, N"}.get(form, "m")

    @classmethod
    def load(cls, path: str | Path, tolerance: float = 0.0) -> Surrogate:
        """Read a model file.

        Args:
            path: the file.
            tolerance: keep only the terms needed for this relative snapshot error [-]; 0 keeps all. The accuracy was
                measured with all terms: a model that loses some loses it too, and its errors are nan.

        Raises:
            ModelError: no file, no model, or a model of another format.
        """
        if not tolerance >= 0:
            raise ModelError(f"tolerance must be at least 0, got {tolerance}")
        try:
            with h5py.File(path, "r") as file:
                if file.attrs.get("format") != FORMAT:
                    raise ModelError(f"{path}: must be a model of format {FORMAT}, got {file.attrs.get('format')}")
                forms = {name: _read_form(file[name]) for name in FORMS if name in file}
                plain = {
                    name: json.loads(file.attrs[name]) for name in ("parameters", "scene", "accuracy", "provenance")
                }
                lead, nodes = int(file.attrs["lead"]), file["nodes"][:].astype(float)
        except ModelError:
            raise
        except FileNotFoundError:
            raise ModelError(f"{path}: No such file") from None
        except (OSError, KeyError, ValueError, TypeError, RuntimeError) as error:
            raise ModelError(f"{path}: is not a model file, or a damaged one ({str(error).splitlines()[0]})") from None
        needed = ["free", "onset", "contact"] if plain["parameters"][-1]["name"] == "d" else ["free"]
        if "displacement" in plain["scene"]["sampling"]["store"]:
            needed += [f"{name}_displacement" for name in needed if name != "onset"]
        damaged = [name for name in needed if name not in forms or not forms[name].finite]
        if damaged or not 0 <= lead < len(plain["parameters"]):
            raise ModelError(f"{path}: is a damaged model file ({', '.join(damaged) or 'lead'})")
        if tolerance > 0:
            fewer = {name: form.truncated(tolerance) for name, form in forms.items()}
            if any(fewer[name].terms < form.terms for name, form in forms.items()):
                forms, plain["accuracy"] = fewer, {}
        return cls(forms=forms, lead=lead, nodes=nodes, **plain)


def _read_form(group: h5py.Group) -> Separated:
    axes = range(len(group.attrs["kinds"]))
    return Separated(
        nodes=[group[f"nodes_{a}"][:] for a in axes],
        kinds=[str(kind) for kind in group.attrs["kinds"]],
        factors=[group[f"factor_{a}"][:] for a in axes],
        modes=group["modes"][:].astype(float),
        errors=group["errors"][:],
    )
