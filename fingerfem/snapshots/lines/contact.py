"""A line of contact states on the grid: the plane moves from where it touches to its nearest distance."""

from __future__ import annotations

import numpy as np

from fingerfem.equilibrium.failures import LoadNotReached
from fingerfem.snapshots.lines.between import between
from fingerfem.snapshots.lines.setting import BETWEEN, Arrays, Setting
from fingerfem.snapshots.recorder import Recorder
from rom.snapshots.description import Line
from rom.snapshots.snapshot_set import read_task


def needs(setting: Setting, task: str, line: Line) -> list[str]:
    """Tasks that must be done before: the free states of the same other tensions, and what it refines."""
    return [f"free-{line.index[0]}", *(() if task in setting.description.lines else setting.before(task))]


def solve(setting: Setting, task: str, line: Line) -> Arrays:
    """The states of the line's nodes; of the first line, also states between its contact regimes."""
    description, record, nodes = setting.description, setting.recorder(), list(line.nodes)
    free = read_task(setting.path, f"free-{line.index[0]}", ("onset", "converged"))
    if np.isnan(free["onset"]):
        unsolved = f"free-{line.index[0]} has states without an answer"
        reason = unsolved if not free["converged"].all() else "the free finger does not reach the nearest plane"
        return give_up(setting, task, line, reason)
    tensions, continuation = _tensions(setting, line, float(free["onset"])), setting.model.continuation
    known, given = _known(setting, task), setting.given(line)
    if nodes[0] == 0 and 0 in given:
        setting.take(record, given[0])
        reach = record.reaches[0]
        if not description.has_field:
            setting.start_free(line.index[0], tensions)
    else:
        setting.start_free(line.index[0], tensions)
        if 0 in known:
            continuation.start(tensions, None, setting.numbering.scatter(known[0][1]))
        reach = _touch(setting, record, tensions, nodes)
    path = reach - setting.nearest  # of the plane [m]
    if path < setting.shortest_path:
        if nodes[0] > 0:
            record.state(tensions, None)
        return record.arrays() | {"nodes": np.array(nodes[:1])}
    at, counted = 0, None if nodes[0] == 0 else 0
    for node in [node for node in nodes if node > 0]:
        if node in given:
            setting.take(record, given[node])
            at = node
            continue
        before = max((other for other in known if other < node), default=0)
        if before > at:
            continuation.start(tensions, known[before][0], setting.numbering.scatter(known[before][1]))
            record.restarted()
        record.state(tensions, reach - description.contact_nodes[node] * path, counted)
        at, counted = node, None
    own = task in description.lines
    added = between(setting.model, record, tensions, reach, setting.nearest) if own else 0
    return record.arrays() | {"nodes": np.array([*nodes, *[BETWEEN] * added])}


def give_up(setting: Setting, task: str, line: Line, reason: str) -> Arrays:
    """The same without an answer."""
    record, onset = setting.recorder(), float(read_task(setting.path, f"free-{line.index[0]}", ("onset",))["onset"])
    for _ in line.nodes:
        record.failed(_tensions(setting, line, onset), np.nan, reason)
    return record.arrays() | {"nodes": np.array(line.nodes)}


def _tensions(setting: Setting, line: Line, onset: float) -> np.ndarray:
    description, (j, i) = setting.description, line.index
    highest = description.parameters[description.lead]["upper"]
    return description.insert_lead(description.others[j], onset + description.onset_nodes[i] * (highest - onset))


def _touch(setting: Setting, record: Recorder, tensions: np.ndarray, nodes: list[int]) -> float:
    """Bring the model to where the plane would be touched and note that; returns the reach there [m].

    The state itself is noted if it is one of the line's.
    """
    if nodes[0] == 0:
        record.state(tensions, None)
        return record.reaches[0]
    try:
        setting.model.continuation.advance(tensions, None)
    except LoadNotReached as failure:
        record.broken(failure)
        return np.nan
    record.touch()
    return setting.model.problem.reach()


def _known(setting: Setting, task: str) -> dict[int, tuple[float, np.ndarray]]:
    """Distance [m] and displacement of the line's states that tasks before this one have, by their nodes."""
    found: dict[int, tuple[float, np.ndarray]] = {}
    for name in setting.before(task) if setting.description.has_field else []:
        stored = read_task(setting.path, name, ("nodes", "parameters", "converged", "displacement"))
        for k in np.flatnonzero(stored["converged"]):
            found[int(stored["nodes"][k])] = (float(stored["parameters"][k, -1]), stored["displacement"][k])
    return found
