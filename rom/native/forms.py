"""Values of separated forms by compiled code (rom/native/kernel.h), with arrays of NumPy."""

from __future__ import annotations

from typing import Any

import numpy as np

from rom.native import EVALUATION, pointer

AXES, TERMS, COMPONENTS, MODES, ROW = range(5)  # columns of a form's row and their number, as in kernel.h


def memory_of(tables: Any) -> Any:
    """Memory for a function of a struct fingerfem_tables, or of a kernel with it, to work in: a call's own."""
    own = tables if EVALUATION.ffi.typeof(tables).kind == "pointer" else EVALUATION.ffi.addressof(tables)
    return pointer(np.empty(EVALUATION.functions.fingerfem_forms_memory(own)))


def values(tables: Any, form: int, points: np.ndarray) -> np.ndarray:
    """Values of a form, shape (n, components), at points, shape (n, axes).

    Outside an axis the end pieces go on for one interval, and then stay: whoever calls decides what lies inside.
    """
    points = np.ascontiguousarray(points, float)
    found = np.empty((len(points), tables.forms[ROW * form + COMPONENTS]))
    given = pointer(points), memory_of(tables), pointer(found), EVALUATION.ffi.NULL
    EVALUATION.functions.fingerfem_form(tables, form, len(points), *given)
    return found


def values_and_gradients(tables: Any, form: int, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same with gradients by the axes, shape (n, components, axes)."""
    points = np.ascontiguousarray(points, float)
    components, axes = tables.forms[ROW * form + COMPONENTS], points.shape[1]
    found, gradients = np.empty((len(points), components)), np.empty((len(points), components, axes))
    given = pointer(points), memory_of(tables), pointer(found), pointer(gradients)
    EVALUATION.functions.fingerfem_form(tables, form, len(points), *given)
    return found, gradients
