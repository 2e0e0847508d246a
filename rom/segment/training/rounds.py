"""How many lines of states the map of a segment needs: more of their sequence, until what is left out is predicted.

Lines are a low-discrepancy sequence of tensions and wrenches, of which any first ones fill the box evenly. To take
those first at which fits disagree, or which tell most of the coefficients (D-optimal), was no better: poses are smooth,
and a polynomial of the whole box learns from every state.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from rom.fit.mesh_error import covering
from rom.segment.training.contact_error import relative_force_errors
from rom.segment.training.mesh_correction import corrected_pose
from rom.segment.training.mirrors import with_images
from rom.segment.training.pose_fit import PoseFit, first_fit
from rom.snapshots.plan import Round
from rom.snapshots.pressed_states import PressedStates, read_pressed_states
from rom.snapshots.snapshot_set import Description, SnapshotSet

GROWTH = 1.35  # how many times as many lines a set has after a round: ranks wait for each other between rounds [-]
TERMS = 2500  # most products of a fit


class Growth:
    """Says how a set of pressed states grows.

    Args:
        coarse: states on a coarser mesh, whose map the set corrects; None for a set by itself.
    """

    def __init__(self, coarse: SnapshotSet | None = None):
        self._coarse = coarse

    def next_round(self, snapshots: SnapshotSet, tolerance: float) -> Round:
        """The lines to solve next for a relative error of the contact force, 95th percentile [-].

        Raises:
            SnapshotError: of a finger of several segments, or no state has an answer.
        """
        lines, description = len(snapshots.plan.lines), snapshots.description
        error = self._error(_states(snapshots), description)
        more = range(lines, min(int(np.ceil(GROWTH * lines)), len(description.wrenches)))
        if error <= tolerance or not more:
            return Round(error=error, threshold=0.0, lines={}, finest=error > tolerance)
        return Round(error=error, threshold=0.0, lines={f"pressed-{k}": description.pressed_line(k) for k in more})

    def _error(self, states: PressedStates, description: Description) -> float:
        """What a map of these states would expect of itself [-]."""
        if self._coarse is None:
            return float(np.nanquantile(first_fit(states, _box(description), TERMS).left_out, 0.95))
        before = self._before
        _, poses = corrected_pose(before.polynomial, before.weights, states)
        errors = relative_force_errors(states, poses)
        own = float(np.nanquantile(before.left_out, 0.95))
        return float(np.hypot(covering(errors[~np.isnan(errors)]), own))

    @cached_property
    def _before(self) -> PoseFit:
        assert self._coarse is not None, "only called where there is one"
        return first_fit(_states(self._coarse), _box(self._coarse.description), TERMS)


def _states(snapshots: SnapshotSet) -> PressedStates:
    return with_images(read_pressed_states(snapshots), snapshots.description.scene)


def _box(description: Description) -> np.ndarray:
    return np.array([[one["lower"], one["upper"]] for one in description.parameters])
