"""A line of free states along the lead tension."""

import numpy as np

from fingerfem.snapshots.lines.setting import Arrays, Setting
from rom.dataset.description import Line


def needs(setting: Setting, task: str, line: Line) -> list[str]:
    """No task must be done before."""
    return []


def solve(setting: Setting, task: str, line: Line) -> Arrays:
    """The states of the line's nodes."""
    record, given = setting.recorder(), setting.given(line)
    setting.model.continuation.rest()
    for node in line.nodes:
        if node in given:
            setting.take(record, given[node])
        else:
            record.state(_tensions(setting, line, node), None)
    return record.arrays() | {"nodes": np.array(line.nodes)}


def give_up(setting: Setting, task: str, line: Line, reason: str) -> Arrays:
    """The same without an answer."""
    record = setting.recorder()
    for node in line.nodes:
        record.failed(_tensions(setting, line, node), np.nan, reason)
    return record.arrays() | {"nodes": np.array(line.nodes)}


def _tensions(setting: Setting, line: Line, node: int) -> np.ndarray:
    description = setting.description
    lead = description.tension_nodes[description.lead][node]
    return description.insert_lead(description.others[line.index[0]], lead)
