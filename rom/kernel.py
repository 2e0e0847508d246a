"""The compiled answer: tip, contact force and touch distance with their derivatives, in microseconds."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from rom import chart as contact_chart
from rom.separated import Packed, evaluate


class Kernel(NamedTuple):
    """What the compiled code reads."""

    free: Packed  # tip [m] and heights of the nodes that can touch first [m], by tensions
    contact: Packed  # what contact adds to the tip [m], and contact force [N], by contact-aligned coordinates
    chart: contact_chart.Chart
    lower: np.ndarray
    upper: np.ndarray
    has_obstacle: bool


@njit(cache=True)
def answer(kernel: Kernel, point: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
    """Outputs, shape (5,), their derivatives by the parameters, shape (5, p), and whether the point is inside.

    A point outside is moved to the nearest inside; derivatives across a wall are then zero.
    """
    p = len(point)
    tensions = p - 1 if kernel.has_obstacle else p
    inside = True
    held = point.copy()
    for j in range(tensions):
        if not (kernel.lower[j] <= point[j] <= kernel.upper[j]):
            inside = False
            held[j] = kernel.upper[j] if point[j] > kernel.upper[j] else kernel.lower[j]  # nan goes low
    value, gradient = evaluate(kernel.free, held[:tensions])
    out = np.zeros(5)
    jacobian = np.zeros((5, p))
    out[:3] = value[:3]
    jacobian[:3, :tensions] = gradient[:3]
    out[4] = np.nan
    if kernel.has_obstacle:
        first = 3
        for j in range(4, len(value)):
            if value[j] > value[first]:
                first = j
        out[4] = value[first]
        jacobian[4, :tensions] = gradient[first]
        if not point[p - 1] >= out[4]:  # a plane that is not touched may stand anywhere: the free answer is exact
            if not (kernel.lower[p - 1] <= point[p - 1] <= kernel.upper[p - 1]):
                inside = False
                held[p - 1] = kernel.upper[p - 1] if point[p - 1] > kernel.upper[p - 1] else kernel.lower[p - 1]
            if held[p - 1] < out[4]:
                where, turned = contact_chart.coordinates(kernel.chart, held, out[4], gradient[first])
                added, slope = evaluate(kernel.contact, where)
                out[:4] += added
                for i in range(4):
                    for j in range(p):
                        for k in range(p):
                            jacobian[i, j] += slope[i, k] * turned[k, j]
                if out[3] < 0.0:  # a spline may swing below zero just after touch; a plane never pulls
                    out[3] = 0.0
    if not inside:
        for j in range(p):
            if held[j] != point[j]:
                jacobian[:, j] = 0.0
    return out, jacobian, inside


@njit(cache=True)
def answers(kernel: Kernel, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Outputs, shape (n, 5), and whether inside, shape (n,), of points, shape (n, p)."""
    out = np.empty((len(points), 5))
    inside = np.empty(len(points), np.bool_)
    for i in range(len(points)):
        out[i], _, inside[i] = answer(kernel, points[i])
    return out, inside
