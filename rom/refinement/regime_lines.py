"""Lines that a set still needs where contact regimes have few states: between lines beside each other on its grid.

A regime that is small in the box, such as a plate that rolls over its face, would be known from a handful of states. It
gets scattered lines half way between a line that visits it and its neighbours, whether these visit it too or not: what
it is like inside, and where it ends, are both to be known.
"""

from __future__ import annotations

from collections import Counter

import numpy as np

from rom.snapshots.contact_regimes import Code
from rom.snapshots.plan import Round
from rom.snapshots.snapshot_set import SnapshotSet

ENOUGH_STATES = 60  # states of a regime
STATES_OF_A_LINE = 3  # states of a regime that a line which visits it adds, about
MOST_LINES = 0.3  # share of the set's lines that may be added


def between_regimes(snapshots: SnapshotSet, _: float = 0.0) -> Round:
    """One round of such lines; none where the set has no plane or no grid, or has had its round."""
    description = snapshots.description
    done = Round(error=0.0, threshold=0.0, lines={}, finest=True)
    if not description.has_obstacle or description.scattered or snapshots.plan.rounds:
        return done
    visits, counts = _visits(snapshots)
    candidates = _neighbours(snapshots, visits)
    chosen: dict[tuple[float, ...], None] = {}  # a set that keeps its order
    for code, count in sorted(counts.items(), key=lambda item: (item[1], item[0])):
        wanted = -(-(ENOUGH_STATES - count) // STATES_OF_A_LINE)
        places = [place for place, codes in candidates.items() if code in codes]
        for place in places[:: max(len(places) // max(wanted, 1), 1)][: max(wanted, 0)]:
            chosen[place] = None
    most = int(MOST_LINES * sum(line.kind == "contact" for line in description.lines.values()))
    lines = {
        f"scattered-{k}": description.scattered_line(k, tensions) for k, tensions in enumerate(list(chosen)[:most])
    }
    return Round(error=0.0, threshold=0.0, lines=lines, finest=not lines)


def _visits(snapshots: SnapshotSet) -> tuple[dict[tuple[int, ...], tuple[np.ndarray, set[Code]]], Counter[Code]]:
    """Tensions [N] and regimes of every contact line by its place on the grid; and the states of every regime."""
    visits: dict[tuple[int, ...], tuple[np.ndarray, set[Code]]] = {}
    counts: Counter[Code] = Counter()
    for task, line in snapshots.description.lines.items():
        if line.kind != "contact":
            continue
        stored = snapshots.task(task)
        touching = stored["converged"] & (stored["contact_force"] > 0)
        codes = [tuple(int(sign) for sign in code) for code in stored["regime"][touching]]
        counts.update(codes)
        place = tuple(int(k) for k in snapshots.on_grid(line)[0][:-1])
        visits[place] = stored["parameters"][0, :-1], set(codes)
    return visits, counts


def _neighbours(
    snapshots: SnapshotSet, visits: dict[tuple[int, ...], tuple[np.ndarray, set[Code]]]
) -> dict[tuple[float, ...], set[Code]]:
    """Half way between lines beside each other: tensions [N], and the regimes that either visits."""
    found = {}
    for place, (tensions, codes) in sorted(visits.items()):
        for a in range(len(place)):
            beside = (*place[:a], place[a] + 1, *place[a + 1 :])
            if beside in visits:
                other, others = visits[beside]
                middle = tuple(((tensions + other) / 2).tolist())
                found[middle] = codes | others
    return found
