"""The file of a separated model: HDF5 that names its units, axes, scene, versions and accuracy (docs/format.md)."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from rom import checked_file
from rom.separated.parts import ContactCoordinates, Errors, Field
from rom.separated.separated_form import Separated

if TYPE_CHECKING:
    from rom.separated.model import SeparatedModel

KIND, FORMAT = "fingerfem separated model", 1
PLAIN = ("parameters", "scene", "accuracy", "provenance")
FREE, CONTACT = ["x", "y", "z", "touch_distance"], ["x", "y", "z", "contact_force", "pad_pressure"]
PER_PATH = "tip -, contact force N/m, displacement -"  # units of what grows with the contact path


def write(model: SeparatedModel, file: h5py.File) -> None:
    """Write a model into an empty file."""
    for name in PLAIN:
        file.attrs[name] = json.dumps(getattr(model, name))
    file.attrs["lead"] = model.lead
    tensions = [(parameter["name"], parameter["unit"]) for parameter in model.parameters[:-1]]
    aligned = [*tensions, ("s", "-")]
    _write_form(file.create_group("free"), model.free, tensions, "m", FREE)
    error = file.create_group("error")
    for name in ("tip", "touch_distance", "displacement", "margin"):
        error.attrs[name] = getattr(model.errors, name)
    error.attrs["unit"] = "m"
    cells, per_path = [model.cells] * len(model.parameters), PER_PATH + (", pad pressure Pa/m" if model.has_pad else "")
    checked_file.dataset(error, "contact", _rounded_up(model.errors.contact).reshape(*cells, -1), per_path)
    contact = file.create_group("contact")
    contact.attrs["nearest"], contact.attrs["soft"] = model.coordinates
    checked_file.dataset(contact, "answered", model.answered.astype(np.uint8).reshape(cells), "-")
    names = CONTACT[: len(model.contact.modes)]
    _write_form(contact, model.contact, aligned, "-, -, -, N/m, Pa/m", names)
    if model.displacements is not None:
        moved = file.create_group("displacement")
        checked_file.dataset(moved, "nodes", model.displacements.nodes.astype(np.float32), "m")
        checked_file.dataset(moved, "basis", model.displacements.basis, "-")
        checked_file.dataset(moved, "free", model.displacements.free, "m")
        checked_file.dataset(moved, "contact", model.displacements.contact, "-")


def _rounded_up(errors: np.ndarray) -> np.ndarray:
    """Errors to 7 binary digits, by less than 2 % larger: few digits compress well."""
    mantissa, exponent = np.frexp(errors)
    return np.ldexp(np.ceil(mantissa * 128) / 128, exponent)


def _write_form(group: h5py.Group, form: Separated, axes: list[tuple[str, str]], unit: str, names: list[str]) -> None:
    """A separated form; `names` are those of its components."""
    checked_file.dataset(group, "modes", form.modes, unit)
    group["modes"].attrs["components"] = ", ".join(names)
    checked_file.dataset(group, "errors", form.errors, "-")
    checked_file.dataset(group, "lost", form.lost, unit)
    group.attrs["functions"] = "hermite"
    for a, (axis, axis_unit) in enumerate(axes):
        factor = form.factors[a]
        checked_file.dataset(group, f"nodes_{a}", np.linspace(form.lower[a], form.upper[a], len(factor)), axis_unit)
        group[f"nodes_{a}"].attrs["axis"] = axis
        checked_file.dataset(group, f"values_{a}", factor, "-")
        checked_file.dataset(group, f"slopes_{a}", form.slopes[a], f"1/{axis_unit}")


def fields(file: h5py.File) -> dict[str, Any]:
    """The fields of a SeparatedModel by name."""
    plain = {name: json.loads(file.attrs[name]) for name in PLAIN}
    error, contact = file["error"], file["contact"]
    rates = error["contact"][:].astype(float)
    moved = None
    if "displacement" in file:
        group = file["displacement"]
        moved = Field(
            nodes=group["nodes"][:].astype(float),
            basis=group["basis"][:],
            free=group["free"][:].astype(float),
            contact=group["contact"][:].astype(float),
        )
    return plain | {
        "lead": int(file.attrs["lead"]),
        "free": _read_form(file["free"]),
        "contact": _read_form(contact),
        "coordinates": ContactCoordinates(float(contact.attrs["nearest"]), float(contact.attrs["soft"])),
        "answered": contact["answered"][:].ravel() != 0,
        "errors": Errors(
            tip=float(error.attrs["tip"]),
            displacement=float(error.attrs["displacement"]),
            touch_distance=float(error.attrs["touch_distance"]),
            contact=rates.reshape(-1, rates.shape[-1]),
            margin=float(error.attrs["margin"]),
        ),
        "displacements": moved,
    }


def _read_form(group: h5py.Group) -> Separated:
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
