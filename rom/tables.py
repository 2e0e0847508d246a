"""Separated forms as plain arrays, evaluated by plain loops."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rom.compiled import compiled

if TYPE_CHECKING:
    from rom.separated import Separated


class Tables(NamedTuple):
    """Separated forms, one after another."""

    data: np.ndarray  # pieces of all axes and modes of all forms
    forms: np.ndarray  # (forms, 4): axes, terms, outputs, where its modes are in `data`
    axes: np.ndarray  # (forms, axes, 2): intervals, where their pieces are in `data`
    scales: np.ndarray  # (forms, axes, 2): lower end, intervals per unit


def tables(forms: Sequence[Separated]) -> Tables:
    """Forms as plain arrays."""
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
    return Tables(np.concatenate(parts), heads, spans, scales)


# Sums may be taken in any order, so that they are vectorised.
ANY_ORDER = {"reassoc", "contract", "nsz"}


@compiled(fastmath=ANY_ORDER)
def write_products(tables: Tables, f: int, x: np.ndarray, whole: np.ndarray) -> None:
    """Write the products of form f's one-dimensional functions at x into whole[:terms].

    Outside an axis the end pieces go on for one interval, and then stay: whoever calls decides what lies inside.
    """
    terms = tables.forms[f, 1]
    for k in range(terms):
        whole[k] = 1.0
    for a in range(tables.forms[f, 0]):
        last = float(tables.axes[f, a, 0])
        t = min(max((x[a] - tables.scales[f, a, 0]) * tables.scales[f, a, 1], -1.0), last + 1.0)
        i = int(min(max(t, 0.0), last - 1.0))
        t -= i
        c = tables.axes[f, a, 1] + 4 * terms * i
        c0, c1 = tables.data[c : c + terms], tables.data[c + terms : c + 2 * terms]
        c2, c3 = tables.data[c + 2 * terms : c + 3 * terms], tables.data[c + 3 * terms : c + 4 * terms]
        for k in range(terms):
            whole[k] *= c0[k] + t * (c1[k] + t * (c2[k] + t * c3[k]))


@compiled(fastmath=ANY_ORDER)
def write_products_and_slopes(
    tables: Tables, f: int, x: np.ndarray, whole: np.ndarray, own: np.ndarray, slopes: np.ndarray
) -> None:
    """Write the products too, and into slopes[:axes, :terms] their derivatives by every axis; `own` is room."""
    axes, terms = tables.forms[f, 0], tables.forms[f, 1]
    for a in range(axes):
        for k in range(terms):
            slopes[a, k] = 1.0
    for k in range(terms):
        whole[k] = 1.0
    for a in range(axes):
        last = float(tables.axes[f, a, 0])
        t = (x[a] - tables.scales[f, a, 0]) * tables.scales[f, a, 1]
        rate = tables.scales[f, a, 1] if -1.0 <= t <= last + 1.0 else 0.0
        t = min(max(t, -1.0), last + 1.0)
        i = int(min(max(t, 0.0), last - 1.0))
        t -= i
        c = tables.axes[f, a, 1] + 4 * terms * i
        c0, c1 = tables.data[c : c + terms], tables.data[c + terms : c + 2 * terms]
        c2, c3 = tables.data[c + 2 * terms : c + 3 * terms], tables.data[c + 3 * terms : c + 4 * terms]
        by = slopes[a]
        for k in range(terms):
            own[k] = c0[k] + t * (c1[k] + t * (c2[k] + t * c3[k]))
            by[k] *= (c1[k] + t * (2 * c2[k] + t * 3 * c3[k])) * rate
            whole[k] *= own[k]
        for b in range(axes):
            if b != a:
                other = slopes[b]
                for k in range(terms):
                    other[k] *= own[k]


@compiled(fastmath=ANY_ORDER, forceinline=True)
def weighted(data: np.ndarray, weights: np.ndarray, at: int, terms: int) -> float:
    """Terms, weighted by the numbers in `data` from `at` on, and added up."""
    found = 0.0
    for k in range(terms):
        found += weights[k] * data[at + k]
    return found


@compiled(fastmath=ANY_ORDER)
def write_gradient(tables: Tables, f: int, slopes: np.ndarray, j: int, gradient: np.ndarray) -> None:
    """Write the gradient of component j of form f, shape (axes,), from the slopes of its terms."""
    terms = tables.forms[f, 1]
    at = tables.forms[f, 3] + j * terms
    for a in range(tables.forms[f, 0]):
        gradient[a] = weighted(tables.data, slopes[a], at, terms)


@compiled
def write_values_and_gradients(
    tables: Tables,
    f: int,
    x: np.ndarray,
    room: tuple[np.ndarray, np.ndarray, np.ndarray],
    value: np.ndarray,
    gradient: np.ndarray,
) -> None:
    """Write value, shape (m,), and gradient, shape (m, axes), of form f at x, shape (axes,); see `room_for`."""
    whole, own, slopes = room
    write_products_and_slopes(tables, f, x, whole, own, slopes)
    write_weighted(tables, f, whole, value)
    for j in range(tables.forms[f, 2]):
        write_gradient(tables, f, slopes, j, gradient[j])


@compiled(allocates=True)
def room_for(tables: Tables) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Room for the products of any of the forms, for those of one axis, and for slopes."""
    terms = tables.forms[:, 1].max()
    return np.empty(terms), np.empty(terms), np.empty((tables.forms[:, 0].max(), terms))


@compiled(allocates=True)
def evaluate(tables: Tables, f: int, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Value, shape (m,), and gradient, shape (m, axes), of form f at x, shape (axes,)."""
    axes, m = tables.forms[f, 0], tables.forms[f, 2]
    value, gradient = np.empty(m), np.empty((m, axes))
    write_values_and_gradients(tables, f, x, room_for(tables), value, gradient)
    return value, gradient


@compiled(fastmath=ANY_ORDER)
def write_weighted(tables: Tables, f: int, whole: np.ndarray, value: np.ndarray) -> None:
    """Write the components of form f, or the first of them, from the products of its terms."""
    terms, at = tables.forms[f, 1], tables.forms[f, 3]
    for j in range(min(tables.forms[f, 2], len(value))):
        value[j] = weighted(tables.data, whole, at + j * terms, terms)


@compiled(fastmath=ANY_ORDER)
def write_values(tables: Tables, f: int, x: np.ndarray, whole: np.ndarray, value: np.ndarray) -> None:
    """Write the value of form f at x, or the first of its components, into `value`; `whole` has room for its terms."""
    write_products(tables, f, x, whole)
    write_weighted(tables, f, whole, value)


@compiled(allocates=True)
def values(tables: Tables, f: int, x: np.ndarray) -> np.ndarray:
    """Value of form f at x, shape (m,)."""
    value = np.empty(tables.forms[f, 2])
    write_values(tables, f, x, np.empty(tables.forms[f, 1]), value)
    return value


@compiled
def outside(tables: Tables, f: int, x: np.ndarray) -> float:
    """How far x lies outside the box of form f, by more than an interval, as a share of the box."""
    found = 0.0
    for a in range(tables.forms[f, 0]):
        last = float(tables.axes[f, a, 0])
        t = (x[a] - tables.scales[f, a, 0]) * tables.scales[f, a, 1]
        found = max(found, (-1.0 - t) / last, (t - last - 1.0) / last)
    return found
