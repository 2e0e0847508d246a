"""The compiled answer at many points at once."""

from __future__ import annotations

import numpy as np

from rom.compiled import compiled
from rom.kernel import (
    FORCE,
    PAD,
    TIP,
    TOUCH,
    Kernel,
    Workspace,
    hold_distance,
    hold_tensions,
    leading,
    outputs,
    regime_at,
    workspace,
)
from rom.tables import write_values

BLOCK = 64  # points that are worked on together


@compiled(allocates=True)
def answers(kernel: Kernel, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Outputs, shape (n, m), whether inside, shape (n,), and regimes, -1 without contact, of points, shape (n, p)."""
    n, room = len(points), workspace(kernel)
    out, inside, regimes = np.empty((n, outputs(kernel))), np.empty(n, np.bool_), np.full(n, -1)
    _write_answers(kernel, points, room, np.empty((BLOCK, len(room.free))), out, inside, regimes)
    return out, inside, regimes


@compiled
def _write_answers(
    kernel: Kernel,
    points: np.ndarray,
    room: Workspace,
    free: np.ndarray,
    out: np.ndarray,
    inside: np.ndarray,
    regimes: np.ndarray,
) -> None:
    """Block by block first all as free, then those in contact: two short loops cost less than one that is long."""
    n, d = points.shape[0], points.shape[1] - 1
    tables, held, products = kernel.tables, room.held, room.products[0]
    for begin in range(0, n, BLOCK):
        end = min(begin + BLOCK, n)
        for i in range(begin, end):
            own = free[i - begin]
            inside[i] = hold_tensions(kernel, points[i], held)
            write_values(tables, 0, held, products, own)
            for k in range(3):
                out[i, TIP + k] = own[k]
            out[i, FORCE], out[i, TOUCH], out[i, -1] = 0.0, np.nan, 0.0 if kernel.has_pad else np.nan
            if kernel.has_obstacle:
                out[i, TOUCH] = own[3 + leading(own)]
                inside[i] = hold_distance(kernel, points[i], held, out[i, TOUCH]) and inside[i]
                if held[d] < out[i, TOUCH]:
                    regimes[i] = 0
        for i in range(begin, end):
            if regimes[i] == 0:
                hold_tensions(kernel, points[i], held)
                hold_distance(kernel, points[i], held, out[i, TOUCH])
                for k in range(len(room.free)):
                    room.free[k] = free[i - begin, k]
                regimes[i] = _add_contact(kernel, room, out[i])


@compiled
def _add_contact(kernel: Kernel, room: Workspace, out: np.ndarray) -> int:
    """Add what contact does to the outputs at room.held, where room.free are the free form's values; the regime."""
    r = regime_at(kernel, room.held, out[TOUCH], room)
    size = room.free[3 + kernel.corners[r]] - room.held[-1] if kernel.begins[r] else 1.0
    for i in range(4):
        out[TIP + i] += size * room.added[i]
    out[FORCE] = max(out[FORCE], 0.0)
    if kernel.has_pad:
        out[PAD] = max(size * room.added[kernel.tables.forms[1 + r, 2] - 1], 0.0)
    return r
