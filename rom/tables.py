"""Separated forms as plain arrays for compiled code (rom/native/kernel.h)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rom.native import EVALUATION, pointer

if TYPE_CHECKING:
    from rom.separated import Separated


def tables(forms: Sequence[Separated]) -> dict[str, Any]:
    """What a struct fingerfem_tables of these forms holds or points to, by the names of kernel.h."""
    axes = max(len(form.factors) for form in forms)
    parts: list[np.ndarray] = []
    heads, spans = np.zeros((len(forms), 4), np.int64), np.zeros((len(forms), axes, 2), np.int64)
    scales = np.ones((len(forms), axes, 2))
    offset = 0
    for f, form in enumerate(forms):
        for a, pieces in enumerate(form.pieces):
            spans[f, a] = len(pieces), offset
            scales[f, a] = form.lower[a], len(pieces) / (form.upper[a] - form.lower[a])
            parts.append(pieces.ravel())
            offset += pieces.size
        heads[f] = len(form.factors), form.terms, len(form.modes), offset
        parts.append(np.ascontiguousarray(form.modes).ravel())
        offset += form.modes.size
    return {
        "most_axes": axes,
        "most_terms": int(heads[:, 1].max()),
        "most_components": int(heads[:, 2].max()),
        "forms": heads,
        "axes": spans,
        "scales": scales,
        "data": np.concatenate(parts),
    }


def values(tables: Any, form: int, points: np.ndarray) -> np.ndarray:
    """Values of a form, shape (n, components), at points, shape (n, axes).

    Outside an axis the end pieces go on for one interval, and then stay: whoever calls decides what lies inside.
    """
    points = np.ascontiguousarray(points, float)
    found = np.empty((len(points), tables.forms[4 * form + 2]))
    EVALUATION.functions.fingerfem_form(tables, form, len(points), pointer(points), pointer(found), EVALUATION.ffi.NULL)
    return found


def values_and_gradients(tables: Any, form: int, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same with gradients by the axes, shape (n, components, axes)."""
    points = np.ascontiguousarray(points, float)
    components, axes = tables.forms[4 * form + 2], points.shape[1]
    found, gradients = np.empty((len(points), components)), np.empty((len(points), components, axes))
    EVALUATION.functions.fingerfem_form(tables, form, len(points), pointer(points), pointer(found), pointer(gradients))
    return found, gradients
