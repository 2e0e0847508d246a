"""Number of lines of states that elements need: more of their sequence, until lines that are left out are predicted.

Lines are a low-discrepancy sequence of tensions and wrenches, of which any first ones fill the box evenly. A finger is
smooth in both, and a polynomial of the whole box learns from every state.
"""

from collections.abc import Sequence

import numpy as np

from rom.dataset.plan import Round
from rom.dataset.snapshot_set import SnapshotSet
from rom.elements.fitting.contact_error import relative_force_errors
from rom.elements.fitting.degrees import best_degrees
from rom.elements.fitting.prepared import prepare
from rom.elements.samples.section_states import read_section_states

STALE = 4  # rounds that must make the error smaller
SMALLER = 0.9  # by this factor at least, beside the smallest before [-]
GROWTH = 1.35  # factor by which a round grows a set's lines: ranks wait for each other between rounds [-]


def has_stalled(errors: Sequence[float]) -> bool:
    """True if the last of all rounds' errors [-] are hardly smaller than the smallest before."""
    before, last = errors[:-STALE], errors[-STALE:]
    return bool(before) and min(last) > SMALLER * min(before)


def next_round(snapshots: SnapshotSet, tolerance: float) -> Round:
    """The lines to solve next for a relative error of the contact force, 95th percentile [-].

    Raises:
        SnapshotError: of a finger of several segments, or no state has an answer.
    """
    lines, description = len(snapshots.plan.lines), snapshots.description
    states = read_section_states(snapshots)
    training = prepare(states)
    places, turned, _ = training.left_out(best_degrees(training.score, training.kinds))
    error = float(np.nanquantile(relative_force_errors(states, places, turned), 0.95))
    if error > tolerance and has_stalled([*(one.error for one in snapshots.plan.rounds), error]):
        return Round(error=error, threshold=0.0, lines={}, stalled=True)
    more = range(lines, min(int(np.ceil(GROWTH * lines)), len(description.wrenches)))
    if error <= tolerance or not more:
        return Round(error=error, threshold=0.0, lines={}, finest=error > tolerance)
    return Round(error=error, threshold=0.0, lines={f"pressed-{k}": description.pressed_line(k) for k in more})
