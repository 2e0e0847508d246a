"""Separated forms and the answers of a separated model, by compiled code (separated/evaluation.h)."""

from typing import Any

import numpy as np

from rom.native import LIBRARY, pointer

# Columns of a form's row, and their number.
AXES, TERMS, COMPONENTS, MODES, ROW = (
    getattr(LIBRARY.constants, f"FINGERFEM_{name}") for name in ("AXES", "TERMS", "COMPONENTS", "MODES", "ROW")
)


def memory_of(tables: Any) -> Any:
    """Memory for a function of a struct fingerfem_tables, or of a kernel with it, to work in: a call's own."""
    own = tables if LIBRARY.ffi.typeof(tables).kind == "pointer" else LIBRARY.ffi.addressof(tables)
    return pointer(np.empty(LIBRARY.functions.fingerfem_forms_memory(own)))


def values(tables: Any, form: int, points: np.ndarray) -> np.ndarray:
    """Values of a form, shape (n, components), at points, shape (n, axes).

    Outside an axis the end pieces go on for one interval, and then stay: whoever calls decides what lies inside.
    """
    points = np.ascontiguousarray(points, float)
    results = np.empty((len(points), tables.forms[ROW * form + COMPONENTS]))
    given = pointer(points), memory_of(tables), pointer(results), LIBRARY.ffi.NULL
    LIBRARY.functions.fingerfem_form(tables, form, len(points), *given)
    return results


def rows(kernel: Any) -> int:
    """Number of rows of an answer."""
    return LIBRARY.constants.FINGERFEM_PAD + int(kernel.has_pad)


def answer(kernel: Any, point: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
    """Answer, shape (m,), its derivatives by the parameters, shape (m, p), and whether the point is inside.

    The m = 5 rows are tip [m], contact force [N] and touch distance [m]; a sixth is the pad's pressure [Pa], if the
    model has it. A point outside is moved to the nearest inside; derivatives across a wall are then zero.

    Args:
        kernel: a struct fingerfem_kernel.
        point: contiguous, shape (p,).
    """
    m = rows(kernel)
    out, jacobian = np.empty(m), np.empty((m, len(point)))
    given = pointer(point), memory_of(kernel.tables), pointer(out), pointer(jacobian)
    inside = LIBRARY.functions.fingerfem_answer(kernel, *given)
    return out, jacobian, bool(inside)


def answers(kernel: Any, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Answers, shape (n, m), and whether inside, shape (n,), of points, shape (n, p)."""
    points, n = np.ascontiguousarray(points, float), len(points)
    out, inside = np.empty((n, rows(kernel))), np.empty(n, np.bool_)
    given = pointer(points), memory_of(kernel.tables), pointer(out), pointer(inside, "uint8_t[]")
    LIBRARY.functions.fingerfem_answers(kernel, n, *given)
    return out, inside


def contact_errors(
    kernel: Any, rates: np.ndarray, margin: float, points: np.ndarray, touch_distances: np.ndarray
) -> np.ndarray:
    """Estimated errors of contact: of tip [m], force [N], displacement [m], pad pressure [Pa]; shape (n, k).

    Args:
        kernel: a struct fingerfem_kernel.
        rates: of the errors, shape (cells, ..., k), see rom.separated.errors.Errors.
        margin: likewise [m].
        points: they may lie outside the box, shape (n, p).
        touch_distances: there, shape (n,) [m].
    """
    points, errors = np.ascontiguousarray(points, float), np.empty((len(points), rates.shape[-1]))
    LIBRARY.functions.fingerfem_contact_errors(
        kernel,
        pointer(np.ascontiguousarray(rates, float)),
        rates.shape[-1],
        margin,
        len(points),
        pointer(points),
        pointer(np.ascontiguousarray(touch_distances, float)),
        pointer(errors),
    )
    return errors
