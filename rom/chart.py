"""Contact-aligned coordinates: where the kink of touch becomes a face of the grid.

Touch happens on a curved surface d = D0(F) of the parameters; across it everything has a kink that no product of
one-dimensional functions follows. After touch, two of the parameters are therefore replaced:

    s  = (D0(F) - d) / (D0(F) - d_min)           the plane's way from touch (0) to its nearest (1)
    xi = (F_l - F_c(F')) / (F_l,max - F_c(F'))   the lead tension's way from onset (0) to its highest (1)

D0 is the touch distance, F_l the lead tension (of the tendon that bends the finger most towards the plane), F' the
others, and F_c the onset: the lead tension at which D0 = d_min, below which no plane of the scene is ever touched, or
the lowest, where that touches already. So the contact states fill the box of (F', xi, s), and contact force and what
contact adds to the free displacement vanish on its face s = 0.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from rom.separated import Packed, evaluate


class Chart(NamedTuple):
    """What the coordinates depend on besides the touch distance."""

    lead: int  # index of the lead tension
    highest: float  # of the lead tension [N]
    nearest: float  # distance of the plane [m]
    onset: Packed  # F_c as a function of the other tensions [N]


@njit(cache=True)
def coordinates(
    chart: Chart, point: np.ndarray, touch_distance: float, touch_gradient: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Contact-aligned coordinates and their derivatives.

    Args:
        chart: the chart.
        point: tensions [N], then d [m], shape (p,).
        touch_distance: D0 at these tensions [m], above d.
        touch_gradient: dD0/dF, shape (p - 1,) [m/N].

    Returns:
        coordinates, shape (p,): tensions with the lead's place taken by xi, then s; and their derivatives by the
        parameters, shape (p, p). Coordinates are held to [0, 1]; where they are held their derivatives are zero.
    """
    p = len(point)
    tensions = p - 1
    others = np.empty(tensions - 1)
    k = 0
    for j in range(tensions):
        if j != chart.lead:
            others[k] = point[j]
            k += 1
    onset, onset_gradient = evaluate(chart.onset, others)
    moved = point.copy()
    derivative = np.zeros((p, p))
    for j in range(p):
        derivative[j, j] = 1.0

    span = chart.highest - onset[0]
    xi = (point[chart.lead] - onset[0]) / span
    derivative[chart.lead, chart.lead] = 0.0
    if 0.0 < xi <= 1.0:
        derivative[chart.lead, chart.lead] = 1.0 / span
        k = 0
        for j in range(tensions):
            if j != chart.lead:
                derivative[chart.lead, j] = (xi - 1.0) / span * onset_gradient[0, k]
                k += 1
    moved[chart.lead] = min(max(xi, 0.0), 1.0)

    way = touch_distance - chart.nearest
    s = (touch_distance - point[p - 1]) / way if way > 0.0 else 0.0
    derivative[p - 1, p - 1] = 0.0
    if 0.0 < s <= 1.0:
        derivative[p - 1, p - 1] = -1.0 / way
        for j in range(tensions):
            derivative[p - 1, j] = (1.0 - s) / way * touch_gradient[j]
    moved[p - 1] = min(max(s, 0.0), 1.0)
    return moved, derivative
