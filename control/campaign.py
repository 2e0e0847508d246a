"""The authors' sweep: hold one force at many distances from many starts, every answer judged.

Chenevier et al., PLoS ONE 13(2): e0192052 (2018), table 1: 100 distances times 100 starts.
"""

from __future__ import annotations

from time import perf_counter_ns
from typing import Any

import numpy as np

from control.finger import Finger
from rom import Surrogate


def run(model: Surrogate, starts: int, contact_force: float) -> dict[str, Any]:
    """Hold `contact_force` [N] at sqrt(starts) distances from sqrt(starts) lead tensions each.

    Returns:
        starts: the square that was run, the nearest to what was asked; counts of converged, unreachable and failed
        answers; out_of_limits: answers beyond the trained tensions; and the time of one call, mean, median, 99th
        percentile and largest [us].

    Raises:
        ValueError: a contact force that is not above 0, or a model without an obstacle.
    """
    if not (np.isfinite(contact_force) and contact_force > 0):
        raise ValueError(f"contact_force must be above 0 N, got {contact_force}")
    side = max(2, round(np.sqrt(starts)))
    lower, upper = model.limits
    finger, lead = Finger(model), model.lead
    cases = [
        (d, f) for d in np.linspace(lower[-1], upper[-1], side) for f in np.linspace(lower[lead], upper[lead], side)
    ]
    finger.hold(contact_force, float(np.mean([lower[-1], upper[-1]])))  # compile before the clock runs
    microseconds, counts, beyond = [], {"converged": 0, "unreachable": 0}, 0
    for distance, tension in cases:
        start = lower[:-1].copy()
        start[lead] = tension
        begun = perf_counter_ns()
        motion = finger.hold(contact_force, float(distance), start=start)
        microseconds.append((perf_counter_ns() - begun) / 1e3)
        counts[motion.status] = counts.get(motion.status, 0) + 1
        beyond += not (
            np.isfinite(motion.tensions).all()
            and np.all((motion.tensions >= lower[:-1]) & (motion.tensions <= upper[:-1]))
        )
    return {
        "starts": len(microseconds),
        "contact_force": contact_force,
        "converged": counts["converged"],
        "unreachable": counts["unreachable"],
        "failed": len(microseconds) - counts["converged"] - counts["unreachable"],
        "out_of_limits": int(beyond),
        "mean_us": float(np.mean(microseconds)),
        "p50_us": float(np.percentile(microseconds, 50)),
        "p99_us": float(np.percentile(microseconds, 99)),
        "max_us": float(np.max(microseconds)),
    }
