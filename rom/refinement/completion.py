"""A grid completed from the states that are known on it, by their values and derivatives.

Level by level and axis by axis, every new plane of nodes is first predicted from the planes beside it, by the
polynomial through the values and the derivatives of the nearest four (Hermite interpolation, of degree 7); then the
states known there replace what was predicted. How far the cubic through the nearest two is from that prediction tells
where it can be trusted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline, KroghInterpolator

from rom.brief import brief

WIDTH = 4  # planes that a prediction uses


@brief
@dataclass(frozen=True, kw_only=True)
class KnownGrid:
    """What is known of a function of several variables, on a grid of which every stride-th node is complete.

    Attributes:
        axes: nodes of every axis, shapes (n_a,).
        strides: of the complete grid inside, by axis, powers of two.
        known: whether value and derivatives are known, shape (n_1, ..., n_k).
        values: of m quantities, shape (n_1, ..., n_k, m).
        slopes: their derivatives by every axis, each shaped as the values.
        order: of the axes, in which a level splits them.
        open: axes whose derivatives are not known at the first node, such as that by the contact path at touch.
    """

    axes: Sequence[np.ndarray]
    strides: Sequence[int]
    known: np.ndarray
    values: np.ndarray
    slopes: Sequence[np.ndarray]
    order: Sequence[int] = ()
    open: Sequence[int] = ()


@brief
@dataclass(frozen=True, kw_only=True)
class Completed:
    """A function on the whole grid.

    Attributes:
        values: shape (n_1, ..., n_k, m).
        doubt: difference between two predictions where the value is not known, 0 where it is; shaped as the values.
        error: the same, and the error of the nodes beside from which it was predicted.
        stages: when a node is predicted: 0 for the grid that is complete, then 1, 2, ..., shape (n_1, ..., n_k).
        split: axis along which each stage predicts, from stage 1 on.
    """

    values: np.ndarray
    doubt: np.ndarray
    error: np.ndarray
    stages: np.ndarray
    split: list[int]


def complete(function: KnownGrid) -> Completed:
    """Complete a grid; one that is complete already needs no derivatives."""
    count, strides = len(function.axes), list(function.strides)
    inside = tuple(slice(None, None, stride) for stride in strides)
    values = function.values[inside]
    doubt, error = np.zeros_like(values), np.zeros_like(values)
    slopes = [slope[inside] for slope in function.slopes]
    stages, split = np.zeros(values.shape[:-1], int), []
    if max(strides, default=1) > 1:
        slopes = _opened(function, strides, values, slopes)
    while max(strides, default=1) > 1:
        for a in function.order or range(count):
            if strides[a] == 1:
                continue
            old = function.axes[a][:: strides[a]]
            strides[a] //= 2
            new = function.axes[a][:: strides[a]]
            split.append(a)
            inside = tuple(slice(None, None, stride) for stride in strides)
            predicted, along = _hermite(old, new, values, slopes[a], a, WIDTH)
            cubic, _ = _hermite(old, new, values, slopes[a], a, 2)
            across = [along if b == a else _spline(old, new, slope, a) for b, slope in enumerate(slopes)]
            middle = (slice(None),) * a + (slice(1, None, 2),)
            known = function.known[inside].copy()
            kept = (slice(None),) * a + (slice(None, None, 2),)
            known[kept] = False  # of the planes before, nothing changes
            doubt = _between(doubt, predicted.shape, kept)
            doubt[middle] = np.abs(predicted - cubic)[middle]
            error = _between(error, predicted.shape, kept)
            left, right = ((slice(None),) * a + (half,) for half in (slice(None, -2, 2), slice(2, None, 2)))
            error[middle] = doubt[middle] + (error[left] + error[right]) / 2
            stages = _between(stages, predicted.shape[:-1], kept)
            stages[middle] = len(split)
            grids = zip([predicted, *across], [values, *slopes], [function.values, *function.slopes], strict=True)
            for grid, before, stored in grids:
                grid[kept] = before
                grid[known] = stored[inside][known]
            doubt[known] = error[known] = 0.0
            values, slopes = predicted, _opened(function, strides, predicted, across)
    return Completed(values=values, doubt=doubt, error=error, stages=stages, split=split)


def _opened(
    function: KnownGrid, strides: Sequence[int], values: np.ndarray, slopes: Sequence[np.ndarray]
) -> list[np.ndarray]:
    """Derivatives with those at open ends taken from a spline through the values."""
    found = [slope.copy() for slope in slopes]
    for a in function.open:
        nodes = function.axes[a][:: strides[a]]
        found[a][(slice(None),) * a + (0,)] = CubicSpline(nodes, values, axis=a)(nodes[0], 1)
    return found


def _between(array: np.ndarray, shape: tuple[int, ...], kept: tuple[slice, ...]) -> np.ndarray:
    wider = np.zeros(shape, array.dtype)
    wider[kept] = array
    return wider


def _spline(old: np.ndarray, new: np.ndarray, values: np.ndarray, axis: int) -> np.ndarray:
    return np.moveaxis(CubicSpline(old, np.moveaxis(values, axis, 0))(new), 0, axis)


def _hermite(
    old: np.ndarray, new: np.ndarray, values: np.ndarray, slopes: np.ndarray, axis: int, width: int
) -> tuple[np.ndarray, np.ndarray]:
    """Values and derivatives along an axis at new nodes, by the polynomial through the nearest `width` old ones."""
    weights = np.zeros((4, len(new), len(old)))  # of value and slope, for value and slope
    for k, x in enumerate(new):
        i = int(np.clip(np.searchsorted(old, x, side="right") - 1, 0, len(old) - 2))
        first = int(np.clip(i - width // 2 + 1, 0, max(len(old) - width, 0)))
        near = np.arange(first, min(first + width, len(old)))
        unit = np.eye(2 * len(near))
        value, slope = KroghInterpolator(np.repeat(old[near], 2), unit).derivatives(x, 2)
        weights[:, k, near] = value[0::2], value[1::2], slope[0::2], slope[1::2]
    v, s = np.moveaxis(values, axis, 0), np.moveaxis(slopes, axis, 0)
    found = [np.tensordot(weights[k], v, 1) + np.tensordot(weights[k + 1], s, 1) for k in (0, 2)]
    return np.moveaxis(found[0], 0, axis), np.moveaxis(found[1], 0, axis)
