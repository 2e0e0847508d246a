"""Where a set should be refined next: the surrogate's own doubt, before any state is solved.

The doubt of a node is the difference of two predictions from the states known (completion), as a share: of the
tip's largest displacement, and of the contact force, or of a hundredth of the largest force where it is smaller. A
touch distance in doubt counts with the contact force that such an error of the plane's place would make.

A round takes the coarsest nodes whose doubt is above a threshold, which falls as none are left. A line of states begun
for one of its nodes also takes those a tenth as doubtful: they cost little more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from rom.refinement.completion import Completed, complete
from rom.refinement.responses import contact_outputs, contact_response, free_outputs, free_response
from rom.snapshots.description import Description, Line
from rom.snapshots.plan import Round
from rom.snapshots.snapshot_set import SnapshotError, SnapshotSet

THRESHOLDS = 0.3 * 10.0 ** (-0.25 * np.arange(32))  # of the doubt [-], in the order they are tried
ROUND = 0.01  # share of the states so far that a round shall have at least: ranks wait for each other between rounds
BESIDE = 0.1  # share of the threshold above which a line takes further nodes
SMALL = 0.01  # share of the largest contact force below which errors count as of that force
PERCENTILE = 95  # of the doubt over the box: the error that is estimated


def next_round(snapshots: SnapshotSet, tolerance: float) -> Round:
    """What to solve next for a relative error [-].

    Raises:
        SnapshotError: the first grid has states without an answer, or a finger that never reaches the plane.
    """
    _check_first_grid(snapshots)
    parts = [_free(snapshots)] + ([_contact(snapshots)] if snapshots.description.has_obstacle else [])
    error = max(_estimated_error(part) for part in parts)
    if error <= tolerance:
        return Round(error=error, threshold=0.0, lines={})
    enough = ROUND * snapshots.states
    for threshold in THRESHOLDS:
        chosen = [_choose(part, threshold) for part in parts]
        if sum(len(nodes) for part in chosen for nodes in part.values()) >= enough or threshold <= THRESHOLDS[-1]:
            lines = _lines(snapshots, {name: nodes for part in chosen for name, nodes in part.items()})
            return Round(error=error, threshold=float(threshold), lines=lines, finest=not lines)
    raise AssertionError("the last threshold ends every search")


def _check_first_grid(snapshots: SnapshotSet) -> None:
    """Make sure that every state of the first grid has an answer.

    Raises:
        SnapshotError: one has none, or a finger never reaches the plane.
    """
    failures = [failure for failure in snapshots.failures if failure[0] in snapshots.description.lines]
    unreached = [
        task
        for task, line in snapshots.description.lines.items()
        if line.kind == "free" and snapshots.description.has_obstacle and np.isnan(snapshots.task(task)["onset"])
    ]
    if unreached and snapshots.task(unreached[0])["converged"].all():
        raise SnapshotError(f"{snapshots.path}: at some tensions the finger never reaches the nearest plane")
    if failures:
        task, parameters, reason = failures[0]
        raise SnapshotError(
            f"{snapshots.path}: {len(failures)} of {snapshots.states} states did not converge, "
            f"first {task} at {parameters.tolist()}: {reason}"
        )


def _lines(snapshots: SnapshotSet, chosen: dict[tuple, list[int]]) -> dict[str, Line]:
    """The lines of a round by the names of their tasks, those before others that begin from their states."""
    planned, number = snapshots.plan.lines, len(snapshots.plan.rounds)
    lines: dict[str, Line] = {}
    for (kind, j, *onset), nodes in sorted(chosen.items(), key=lambda item: (item[0][0] == "contact", item[0])):
        begun = f"free-{j}"
        if begun not in planned:
            lines[begun] = snapshots.description.free_line(j)
        if kind == "contact":
            lines[f"contact-{j}-{onset[0]}-r{number}"] = Line("contact", (j, onset[0]), tuple(nodes))
        elif begun in planned:
            lines[f"{begun}-r{number}"] = Line("free", (j,), tuple(nodes))
    return lines


@dataclass(frozen=True, kw_only=True)
class _Part:
    """The free or the contact states of a set, on the finest grid; all arrays have its shape.

    Attributes:
        kind: free or contact.
        doubt: of each node by itself, as a share [-].
        error: the same, and that of the nodes it was predicted from [-].
        stages: when a node is predicted; coarse ones first.
        volume: of the box that each node stands for, up to a factor.
        tried: whether the node is among the lines planned already, or can have no answer.
    """

    description: Description
    kind: str
    doubt: np.ndarray
    error: np.ndarray
    stages: np.ndarray
    volume: np.ndarray
    tried: np.ndarray


def _free(snapshots: SnapshotSet) -> _Part:
    response = free_response(snapshots, *free_outputs(snapshots))
    found, tip, stiffness = complete(response), _largest_tip(snapshots), _relative_stiffness(snapshots)

    def share(error: np.ndarray) -> np.ndarray:
        touch = error[..., 3:].max(axis=-1, initial=0.0)
        return np.maximum(np.linalg.norm(error[..., :3], axis=-1) / tip, stiffness * touch)

    return _part(snapshots, "free", response.known, found, share, _volumes(response.axes))


def _contact(snapshots: SnapshotSet) -> _Part:
    response, lead = contact_response(snapshots, *contact_outputs(snapshots)), snapshots.description.lead
    found, tip = complete(response), _largest_tip(snapshots)
    force = np.abs(found.values[..., 3])
    force = np.maximum(force, max(SMALL * force.max(), np.finfo(float).tiny))

    def share(error: np.ndarray) -> np.ndarray:
        return np.maximum(np.linalg.norm(error[..., :3], axis=-1) / tip, error[..., 3] / force)

    # The contact path to the plane's nearest distance, the width of the box at a node, grows with the lead tension.
    path = response.axes[lead].reshape([-1 if a == lead else 1 for a in range(force.ndim)])
    return _part(snapshots, "contact", response.known, found, share, _volumes(response.axes) * path)


def _part(
    snapshots: SnapshotSet,
    kind: str,
    known: np.ndarray,
    found: Completed,
    share: Callable[[np.ndarray], np.ndarray],
    volume: np.ndarray,
) -> _Part:
    tried = np.zeros(volume.shape, bool)
    for line in snapshots.lines.values():
        if line.kind == kind:
            tried[tuple(snapshots.on_grid(line).T)] = True
    if kind == "contact":  # without its state at touch a line says nothing, and nothing is known of its other states
        tried |= (tried & ~known)[..., :1]
    volume = np.where(tried & ~known, 0.0, volume)  # what failed is reported, and no round can mend it
    return _Part(
        description=snapshots.description,
        kind=kind,
        doubt=share(found.doubt),
        error=share(found.error),
        stages=found.stages,
        volume=volume,
        tried=tried,
    )


def _largest_tip(snapshots: SnapshotSet) -> float:
    return float(np.linalg.norm(snapshots.values("free", "tip"), axis=1).max())


def _relative_stiffness(snapshots: SnapshotSet) -> float:
    """By what share of itself contact force grows as the plane comes nearer, in the middle of the box [1/m]."""
    if not snapshots.description.has_obstacle:
        return 0.0
    force = snapshots.values("contact", "contact_force")
    by_distance = np.abs(snapshots.values("contact", "contact_force_jacobian")[:, -1])
    felt = force > SMALL * force.max()
    return float(np.median(by_distance[felt] / force[felt])) if felt.any() else 0.0


def _volumes(axes: Sequence[np.ndarray]) -> np.ndarray:
    found = np.ones(())
    for axis in axes:
        found = found[..., None] * np.gradient(axis)
    return found


def _estimated_error(part: _Part) -> float:
    """95th percentile of the relative error over the box [-]."""
    error = part.error.ravel()
    order = np.argsort(error)
    volume = np.cumsum(part.volume.ravel()[order])
    return float(error[order][np.searchsorted(volume, volume[-1] * PERCENTILE / 100)])


def _choose(part: _Part, threshold: float) -> dict[tuple, list[int]]:
    """Nodes to solve by line, (kind, j) or (kind, j, i); none if no doubt is above the threshold."""
    above = (part.doubt > threshold) & ~part.tried
    if not above.any():
        return {}
    here = (part.stages == part.stages[above].min()) & ~part.tried
    along = part.description.lead if part.kind == "free" else here.ndim - 1
    above, beside, tried = (
        np.moveaxis(mask, along, -1) for mask in (above & here, (part.doubt > BESIDE * threshold) & here, part.tried)
    )
    found: dict[tuple, list[int]] = {}
    for fixed in map(tuple, np.argwhere(beside.any(axis=-1))):
        begun = tried[fixed].any()
        if begun or above[fixed].any():
            nodes = set(np.flatnonzero(beside[fixed]).tolist())
            found[_name(part, fixed)] = sorted(nodes if begun or part.kind == "free" else nodes | {0})
    return found


def _name(part: _Part, fixed: tuple[int, ...]) -> tuple:
    """Kind and index of the line through a node; the lead's place is the onset node of a contact line."""
    description, place = part.description, [int(k) for k in fixed]
    index = [place.pop(description.lead)] if part.kind == "contact" else []
    shape = [len(description.tension_nodes[k]) for k in description.other_axes]
    j = int(np.ravel_multi_index(place, shape)) if shape else 0
    return (part.kind, j, *index)
