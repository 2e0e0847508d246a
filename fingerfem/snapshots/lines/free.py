"""A line of free states along the lead tension, which also finds where contact begins."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from fingerfem.equilibrium.failures import LoadNotReached
from fingerfem.equilibrium.sensitivities import differentiate
from fingerfem.snapshots.lines.setting import Arrays, Setting
from fingerfem.snapshots.recorder import Recorder
from rom.snapshots.description import Line

AT_PLANE = 1e-7  # of the side: how near to the nearest plane the onset's reach is [-]


def needs(setting: Setting, task: str, line: Line) -> list[str]:
    """No task must be done before."""
    return []


def solve(setting: Setting, task: str, line: Line) -> Arrays:
    """The states of the line's nodes, and the onset of contact."""
    record, given = setting.recorder(), setting.given(line)
    setting.model.continuation.rest()
    for node in line.nodes:
        if node in given:
            setting.take(record, given[node])
        else:
            record.state(_tensions(setting, line, node), None)
    return record.arrays() | {"nodes": np.array(line.nodes)} | _onset(setting, line, record)


def give_up(setting: Setting, task: str, line: Line, reason: str) -> Arrays:
    """The same without an answer."""
    record = setting.recorder()
    for node in line.nodes:
        record.failed(_tensions(setting, line, node), np.nan, reason)
    return record.arrays() | {"nodes": np.array(line.nodes)} | _no_onset(setting)


def _tensions(setting: Setting, line: Line, node: int) -> np.ndarray:
    description = setting.description
    lead = description.tension_nodes[description.lead][node]
    return description.insert_lead(description.others[line.index[0]], lead)


def _no_onset(setting: Setting) -> Arrays:
    slopes = np.full(len(setting.description.parameters), np.nan)
    return {"onset": np.array(np.nan), "onset_jacobian": slopes}


def _onset(setting: Setting, line: Line, record: Recorder) -> Arrays:
    """Lead tension at which the free finger reaches the nearest plane [N], nan if it never does.

    `onset_jacobian` has its derivatives by the other tensions [-], shape (p,).
    """
    donor, description = setting.known.donor, setting.description
    known = donor.onset(line) if donor else None
    if known is not None:
        return {"onset": np.array(known[0]), "onset_jacobian": known[1]}
    if not description.has_obstacle:
        return _no_onset(setting)
    lead = np.array(description.tension_nodes[description.lead])[list(line.nodes)]
    gap = np.array(record.reaches) - setting.nearest
    beyond = np.flatnonzero(gap >= 0)
    if not beyond.size or np.isnan(gap[: beyond[0] + 1]).any():
        return _no_onset(setting)
    last = int(beyond[0])
    if last == 0:
        return {"onset": np.array(lead[0]), "onset_jacobian": np.zeros(len(description.parameters))}
    others, continuation = description.others[line.index[0]], setting.model.continuation
    if np.isnan(record.displacements[last - 1]).any():  # of another set that does not keep it
        continuation.rest()
    else:
        continuation.start(description.insert_lead(others, lead[last - 1]), None, record.displacements[last - 1])
    solved = {float(lead[k]): float(gap[k]) for k in (last - 1, last)}

    def gap_at(tension: float) -> float:
        if tension not in solved:
            continuation.advance(description.insert_lead(others, tension), None)
            solved[tension] = setting.model.problem.reach() - setting.nearest
        return solved[tension]

    slope = (gap[last] - gap[last - 1]) / (lead[last] - lead[last - 1])
    near = AT_PLANE * setting.model.scene.geometry.side
    try:
        onset = brentq(gap_at, lead[last - 1], lead[last], xtol=0.1 * near / slope)
        continuation.advance(description.insert_lead(others, onset), None)
    except LoadNotReached:
        return _no_onset(setting)
    by_parameters = differentiate(setting.model.problem, continuation.linearise()).touch_distance
    assert by_parameters is not None
    slopes = np.full(len(description.parameters), np.nan)
    slopes[: len(by_parameters)] = -by_parameters / by_parameters[description.lead]  # along D0 = d_min
    slopes[[description.lead, -1]] = 0.0
    return {"onset": np.array(onset), "onset_jacobian": slopes}
