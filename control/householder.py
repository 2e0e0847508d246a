"""The step of a damped least-squares problem by Householder reflections: normal equations square the condition."""

from __future__ import annotations

import numpy as np

from control.room import Room
from rom.compiled import compiled


@compiled
def solve(room: Room, damping: float) -> None:
    """Write the step with the least |J s - right|^2 + damping |s|^2 over the free variables (Householder)."""
    n, m = len(room.x), len(room.r)
    system, right, weight = room.system, room.right, max(np.sqrt(damping), 1e-150)
    for i in range(m):
        for j in range(n):
            system[i, j] = room.jacobian[i, j] if room.free[j] else 0.0
    for i in range(n):
        right[m + i] = 0.0
        for j in range(n):
            system[m + i, j] = 0.0
        system[m + i, i] = weight if room.free[i] else 1.0
    for j in range(n):
        norm = 0.0
        for i in range(j, m + n):
            norm += system[i, j] ** 2
        norm = np.sqrt(norm)
        alpha = -norm if system[j, j] > 0.0 else norm
        head = system[j, j] - alpha  # the reflection's vector is the column less alpha in row j
        square = head * head
        for i in range(j + 1, m + n):
            square += system[i, j] ** 2
        system[j, j] = alpha
        if square <= 0.0:
            continue
        for k in range(j + 1, n):
            along = head * system[j, k]
            for i in range(j + 1, m + n):
                along += system[i, j] * system[i, k]
            along *= 2.0 / square
            system[j, k] -= along * head
            for i in range(j + 1, m + n):
                system[i, k] -= along * system[i, j]
        along = head * right[j]
        for i in range(j + 1, m + n):
            along += system[i, j] * right[i]
        along *= 2.0 / square
        right[j] -= along * head
        for i in range(j + 1, m + n):
            right[i] -= along * system[i, j]
    for j in range(n - 1, -1, -1):
        found = right[j]
        for k in range(j + 1, n):
            found -= system[j, k] * room.step[k]
        room.step[j] = found / system[j, j] if room.free[j] else 0.0
