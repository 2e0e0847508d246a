"""A line at tensions of its own: the free state, and the plane's path from where it touches to its nearest distance."""

from __future__ import annotations

import numpy as np

from fingerfem.snapshots.lines.between import between
from fingerfem.snapshots.lines.setting import BETWEEN, Arrays, Setting
from rom.snapshots.description import Line
from rom.snapshots.snapshot_set import read_task

ROOTS = 12  # lines whose free state is solved from rest; every other line begins at the nearest of these


def needs(setting: Setting, task: str, line: Line) -> list[str]:
    """The line whose free state this one begins at, the nearest of the roots; none for lines that begin at rest."""
    description = setting.description
    if not description.has_field or not ROOTS <= line.index[0] < len(description.scattered):
        return []
    size = [parameter["upper"] - parameter["lower"] for parameter in description.parameters[: description.tensions]]
    away = (np.array(description.scattered[:ROOTS]) - line.tensions) / size
    return [f"{line.kind}-{np.argmin(np.sum(away**2, axis=1))}"]


def solve(setting: Setting, task: str, line: Line) -> Arrays:
    """The states of the line's nodes, and those between its contact regimes."""
    description, record = setting.description, setting.recorder(edges=True)
    tensions, nodes = np.array(line.tensions), list(line.nodes)
    begin(setting, needs(setting, task, line))
    record.state(tensions, None)
    reach = record.reaches[0]
    path = reach - setting.nearest  # of the plane [m]
    if not path >= setting.shortest_path:  # there is no path, or no plane, or no answer
        return record.arrays() | {"nodes": np.array(nodes[:1])}
    for node in nodes[1:]:
        record.state(tensions, reach - description.contact_nodes[node] * path)
    added = between(setting.model, record, tensions, reach, setting.nearest)
    return record.arrays() | {"nodes": np.array([*nodes, *[BETWEEN] * added])}


def give_up(setting: Setting, task: str, line: Line, reason: str) -> Arrays:
    """The same without an answer."""
    record = setting.recorder(edges=True)
    for _ in line.nodes:
        record.failed(np.array(line.tensions), np.nan, reason)
    return record.arrays() | {"nodes": np.array(line.nodes)}


def begin(setting: Setting, roots: list[str]) -> None:
    """Bring the model to a root's free state, or to rest where it has none."""
    setting.model.continuation.rest()
    for root in roots:
        known = read_task(setting.path, root, ("parameters", "converged", "displacement"))
        if known["converged"][0]:
            tensions = known["parameters"][0, : setting.description.tensions]
            setting.model.continuation.start(tensions, None, setting.numbering.scatter(known["displacement"][0]))
