"""A line of contact states on the grid: the plane moves from where it touches to its nearest distance."""

import numpy as np

from fingerfem.equilibrium.failures import LoadNotReached
from fingerfem.snapshots.lines.setting import Arrays, Setting
from rom.dataset.description import Line
from rom.dataset.snapshot_set import read_task


def needs(setting: Setting, task: str, line: Line) -> list[str]:
    """Tasks that must be done before: the free states of the same other tensions."""
    return [f"free-{line.index[0]}"]


def solve(setting: Setting, task: str, line: Line) -> Arrays:
    """The states of the line's nodes; none where the finger does not reach the nearest plane."""
    j, i = line.index
    free = read_task(setting.path, f"free-{j}", ("touch_distance", "converged"))
    if not free["converged"][i]:
        return give_up(setting, task, line, f"free-{j} has no answer at these tensions")
    record, given, tensions = setting.recorder(), setting.given(line), _tensions(setting, line)
    reach = float(free["touch_distance"][i])
    path = reach - setting.nearest  # of the plane [m]
    if path < setting.shortest_path:
        return record.arrays() | {"nodes": np.zeros(0, int)}
    setting.start_free(j, tensions)
    try:
        setting.model.continuation.advance(tensions, None)
        record.touch()
    except LoadNotReached as failure:
        record.broken(failure)
    for node in line.nodes:
        if node in given:
            setting.take(record, given[node])
        else:
            record.state(tensions, reach - setting.description.contact_nodes[node] * path)
    return record.arrays() | {"nodes": np.array(line.nodes)}


def give_up(setting: Setting, task: str, line: Line, reason: str) -> Arrays:
    """The same without an answer."""
    record = setting.recorder()
    for _ in line.nodes:
        record.failed(_tensions(setting, line), np.nan, reason)
    return record.arrays() | {"nodes": np.array(line.nodes)}


def _tensions(setting: Setting, line: Line) -> np.ndarray:
    description, (j, i) = setting.description, line.index
    return description.insert_lead(description.others[j], description.tension_nodes[description.lead][i])
