"""The model file: HDF5 that names its units, axes, scene, versions and accuracy (docs/format.md)."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from rom import checked_file, limits
from rom.checked_file import ModelError
from rom.components import Components, Errors, Field, Regime
from rom.fit.contact_coordinates import ContactCoordinates
from rom.fit.mesh_error import MeshError
from rom.separated.separated_form import Separated

KIND, FORMAT = "fingerfem surrogate", 4
HERMITE = "hermite"  # one-dimensional functions; cubic splines of older files are stored as these
PLAIN = ("parameters", "scene", "accuracy", "provenance")
PAIRED = ("contact_force", "pad_pressure")  # shares of a mesh's error that are two numbers


def save(model: Components, path: Path) -> None:
    """Write a model, beside and renamed: the file is whole or absent."""
    checked_file.save(path, KIND, FORMAT, lambda stored: _write(model, stored))


def load(path: Path) -> dict[str, Any]:
    """Read a model: the fields of its Components by name.

    Raises:
        ModelError: no file, no model, a damaged one, one of another format, or one that compiled code cannot read.
    """
    return checked_file.load(path, KIND, FORMAT, _checked)


def _checked(file: h5py.File) -> dict[str, Any]:
    found = _read(file)
    limits.check(Components(**found))
    return found


def _write(model: Components, file: h5py.File) -> None:
    file.attrs["format"] = FORMAT
    for name in PLAIN:
        file.attrs[name] = json.dumps(getattr(model, name))
    file.attrs["lead"] = model.lead
    if model.has_field:
        checked_file.dataset(file, "nodes", model.nodes.astype(np.float32), "m")
    tensions = [(parameter["name"], parameter["unit"]) for parameter in model.parameters if parameter["name"] != "d"]
    heights = len(model.free.modes) - 3
    _write_form(file.create_group("free"), model.free, tensions, "m", ["x", "y", "z", *["height"] * heights])
    error = file.create_group("error")
    error.attrs["tip"], error.attrs["touch_distance"] = model.errors.tip, model.errors.touch_distance
    error.attrs["displacement"], error.attrs["margin"] = model.errors.displacement, model.errors.margin
    error.attrs["unit"] = "m"
    if model.errors.mesh is not None:
        error.attrs["mesh"] = json.dumps(asdict(model.errors.mesh))
    if model.has_obstacle:
        aligned = [*tensions, ("s", "-")]
        contact = file.create_group("contact")
        contact.attrs["nearest"], contact.attrs["soft"] = model.coordinates
        cells = [round(len(model.regime_lookup) ** (1 / len(model.parameters)))] * len(model.parameters)
        checked_file.dataset(contact, "map", model.regime_lookup.reshape(cells), "-")
        checked_file.dataset(contact, "near", model.possible_regimes.reshape(cells), "-")
        checked_file.dataset(
            contact,
            "error",
            _rounded_up(model.errors.contact).reshape(*cells, -1),
            "tip m/m, contact force N/m, displacement m/m" + (", pad pressure Pa/m" if model.has_pad else ""),
        )
        for r, regime in enumerate(model.regimes):
            group = contact.create_group(f"regime_{r}")
            group.attrs["code"], group.attrs["corner"], group.attrs["begins"] = (
                regime.code,
                regime.corner,
                regime.begins,
            )
            group.attrs["states"] = regime.states
            group.attrs["sizes"] = np.array(regime.sizes, float)
            units = regime.layout.units("/m" if regime.begins else "")
            _write_form(group, regime.form, aligned, units, regime.layout.names)
    if model.displacements is not None:
        group = file.create_group("displacement")
        checked_file.dataset(group, "free_basis", model.displacements.free_basis, "-")
        _write_form(group.create_group("free"), model.displacements.free, tensions, "m", [])
        if model.displacements.contact_basis is not None:
            checked_file.dataset(group, "contact_basis", model.displacements.contact_basis, "-")
            for r, (regime, form) in enumerate(zip(model.regimes, model.displacements.regimes, strict=True)):
                unit = "m/m" if regime.begins else "m"
                _write_form(group.create_group(f"regime_{r}"), form, aligned, unit, [])


def _rounded_up(errors: np.ndarray) -> np.ndarray:
    """Errors to 7 binary digits, by less than 2 % larger: what they say is a size, and so few digits compress well."""
    mantissa, exponent = np.frexp(errors)
    return np.ldexp(np.ceil(mantissa * 128) / 128, exponent)


def _write_form(group: h5py.Group, form: Separated, axes: list[tuple[str, str]], unit: str, names: list[str]) -> None:
    """A separated form; `names` are those of its components, if they have names."""
    checked_file.dataset(group, "modes", form.modes, unit)
    if names:
        group["modes"].attrs["components"] = ", ".join(names)
    checked_file.dataset(group, "errors", form.errors, "-")
    checked_file.dataset(group, "lost", form.lost, unit)
    group.attrs["functions"] = HERMITE
    for a, (axis, axis_unit) in enumerate(axes):
        factor = form.factors[a]
        checked_file.dataset(group, f"nodes_{a}", np.linspace(form.lower[a], form.upper[a], len(factor)), axis_unit)
        group[f"nodes_{a}"].attrs["axis"] = axis
        checked_file.dataset(group, f"values_{a}", factor, "-")
        checked_file.dataset(group, f"slopes_{a}", form.slopes[a], f"1/{axis_unit}")


def _read_mesh_error(error: h5py.Group) -> MeshError | None:
    if "mesh" not in error.attrs:
        return None
    shares: dict[str, Any] = json.loads(error.attrs["mesh"])
    pairs: dict[str, Any] = {name: _pair(shares.pop(name)) for name in PAIRED if name in shares}
    return MeshError(**pairs | {name: float(one) for name, one in shares.items()})


def _pair(found: Any) -> tuple[float, float]:
    first, second = found
    return float(first), float(second)


def _read(file: h5py.File) -> dict[str, Any]:
    plain = {name: json.loads(file.attrs[name]) for name in PLAIN}
    obstacle = plain["parameters"][-1]["name"] == "d"
    error = file["error"]
    regimes: list[Regime] = []
    contact, coordinates = np.zeros((1, 3)), ContactCoordinates(0.0, 1.0)
    lookup, possible = np.zeros(1, np.int64), np.zeros(1, np.uint64)
    if obstacle:
        group = file["contact"]
        contact, lookup = group["error"][:].astype(float), group["map"][:].ravel().astype(np.int64)
        contact = contact.reshape(-1, contact.shape[-1])
        possible = group["near"][:].ravel().astype(np.uint64)
        coordinates = ContactCoordinates(float(group.attrs["nearest"]), float(group.attrs["soft"]))
        while f"regime_{len(regimes)}" in group:
            regimes.append(_read_regime(group[f"regime_{len(regimes)}"]))
    field = None
    if "displacement" in file:
        group = file["displacement"]
        field = Field(
            free_basis=group["free_basis"][:],
            free=_read_form(group["free"]),
            contact_basis=group["contact_basis"][:] if obstacle else None,
            regimes=[_read_form(group[f"regime_{r}"]) for r in range(len(regimes))],
        )
    return plain | {
        "free": _read_form(file["free"]),
        "regimes": regimes,
        "regime_lookup": lookup,
        "possible_regimes": possible,
        "coordinates": coordinates,
        "errors": Errors(
            tip=float(error.attrs["tip"]),
            displacement=float(error.attrs["displacement"]),
            touch_distance=float(error.attrs["touch_distance"]),
            contact=contact,
            margin=float(error.attrs["margin"]),
            mesh=_read_mesh_error(error),
        ),
        "displacements": field,
        "lead": int(file.attrs["lead"]),
        "nodes": file["nodes"][:].astype(float) if "nodes" in file else np.zeros((0, 3)),
    }


def _read_regime(group: h5py.Group) -> Regime:
    return Regime(
        code=tuple(group.attrs["code"].tolist()),
        corner=int(group.attrs["corner"]),
        begins=bool(group.attrs["begins"]),
        states=int(group.attrs["states"]),
        sizes=group.attrs["sizes"].tolist(),
        form=_read_form(group),
    )


def _read_form(group: h5py.Group) -> Separated:
    if group.attrs["functions"] not in (HERMITE, "cubic"):
        raise ModelError(
            f"{group.file.filename}: must have Hermite functions, got {group.attrs['functions']}: build it anew"
        )
    axes = range(sum(name.startswith("nodes_") for name in group))
    nodes = [group[f"nodes_{a}"][:].astype(float) for a in axes]
    return Separated(
        lower=np.array([axis[0] for axis in nodes]),
        upper=np.array([axis[-1] for axis in nodes]),
        factors=[group[f"values_{a}"][:].astype(float) for a in axes],
        slopes=[group[f"slopes_{a}"][:].astype(float) for a in axes],
        modes=group["modes"][:].astype(float),
        errors=group["errors"][:].astype(float),
        lost=group["lost"][:].astype(float),
    )
