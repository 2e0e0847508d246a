"""A line of contact states on the grid: the plane moves from where it touches to its nearest distance."""

from __future__ import annotations

import numpy as np

from fingerfem.snapshots.lines.setting import Arrays, Setting
from rom.snapshots.description import Line
from rom.snapshots.snapshot_set import read_task


def needs(setting: Setting, task: str, line: Line) -> list[str]:
    """Tasks that must be done before: the free states of the same other tensions."""
    return [f"free-{line.index[0]}"]


def solve(setting: Setting, task: str, line: Line) -> Arrays:
    """The states of the line's nodes; where the plane cannot move, the first of them alone."""
    description, record = setting.description, setting.recorder()
    free = read_task(setting.path, f"free-{line.index[0]}", ("onset", "converged"))
    if np.isnan(free["onset"]):
        unsolved = f"free-{line.index[0]} has states without an answer"
        reason = unsolved if not free["converged"].all() else "the free finger does not reach the nearest plane"
        return give_up(setting, task, line, reason)
    tensions, given = _tensions(setting, line, float(free["onset"])), setting.given(line)
    touch, *nodes = line.nodes
    if touch in given:
        setting.take(record, given[touch])
    if touch not in given or not description.has_field:
        setting.start_free(line.index[0], tensions)
    if touch not in given:
        record.state(tensions, None)
    reach = record.reaches[0]
    path = reach - setting.nearest  # of the plane [m]
    if path < setting.shortest_path:
        return record.arrays() | {"nodes": np.array([touch])}
    for node in nodes:
        if node in given:
            setting.take(record, given[node])
        else:
            record.state(tensions, reach - description.contact_nodes[node] * path)
    return record.arrays() | {"nodes": np.array(line.nodes)}


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
