"""A model without Python: its numbers as a struct fingerfem_model (native/model.h), as a page and an FMU have them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from rom.native import EVALUATION, SEGMENT, Library
from rom.rod.native import ENDS
from rom.rod.touched_segment import TouchedSegment
from rom.separated.separated_form import tables
from rom.snapshots.grid import SHARE, SINGLE, levels
from rom.surrogate import Surrogate

_HERE = Path(__file__).parent / "native"
MODEL = Library(
    "model",
    headers=[_HERE / "model.h"],
    units=[_HERE / "model.c", *EVALUATION.units, *SEGMENT.units],
    includes=SEGMENT,
)


def struct(model: Surrogate | TouchedSegment) -> Any:
    """A struct fingerfem_model."""
    p = len(model.parameters)
    if isinstance(model, TouchedSegment):
        sections = sum(one.struct.places + ENDS for one in model.rod.segments)
        return MODEL.struct("fingerfem_model", parameters=p, sections=sections, touching=model.touching)
    found, edges = edges_of(model) if model.has_field else ({}, 0)
    return MODEL.struct(
        "fingerfem_model", parameters=p, sections=edges, kernel=model.kernel, errors=errors_of(model), **found
    )


def errors_of(model: Surrogate) -> Any:
    """A struct fingerfem_errors."""
    errors, mesh = model.errors, model.errors.mesh
    shares = {} if mesh is None else {"mesh": [mesh.tip, mesh.touch_distance, *mesh.contact_force, *mesh.pad_pressure]}
    return MODEL.struct(
        "fingerfem_errors",
        tip=errors.tip,
        touch_distance=errors.touch_distance,
        margin=errors.margin,
        columns=errors.contact.shape[1],
        rates=errors.contact,
        **shares,
    )


def tolerance(model: Surrogate) -> float:
    """How near to each other two coordinates of its nodes are the same [m]; files keep these in single precision."""
    geometry = model.scene["geometry"]
    return float(SHARE * geometry["side"] + SINGLE * sum(geometry["segments"]))


def edges_of(model: Surrogate) -> tuple[dict[str, Any], int]:
    """A struct fingerfem_edges by its name in the model, and its number of sections; nothing if there are none."""
    moved, half = model.displacements, model.scene["geometry"]["side"] / 2
    assert moved is not None
    rows, signs, rest = [], [], []
    for x in levels(model.nodes[:, 0])[0]:
        for y, z in ((-half, -half), (-half, half), (half, -half), (half, half)):
            for own in (z, -z):  # of a half that is its own mirror image, the other edge
                away = np.abs(model.nodes - [x, y, own]).max(axis=1)
                if away.min() < tolerance(model):
                    rows.append(int(away.argmin()))
                    signs.append([1.0, 1.0, 1.0 if own == z else -1.0])
                    rest.append([x, y, z])
                    break
    if not rows or len(rows) % 4:  # a mesh without nodes there
        return {}, 0
    index = (3 * np.array(rows)[:, None] + np.arange(3)).ravel()

    def basis(whole: np.ndarray | None) -> np.ndarray:
        return np.zeros((0, 0)) if whole is None else np.asarray(whole, float)[index] * np.ravel(signs)[:, None]

    free, contact = basis(moved.free_basis), basis(moved.contact_basis)
    edges = MODEL.struct(
        "fingerfem_edges",
        stations=len(rows) // 4,
        free_modes=free.shape[1],
        contact_modes=contact.shape[1],
        tables=EVALUATION.struct("fingerfem_tables", **tables([moved.free, *moved.regimes])),
        rest=np.array(rest),
        free_basis=free,
        contact_basis=contact,
    )
    return {"edges": edges}, len(rows) // 4
