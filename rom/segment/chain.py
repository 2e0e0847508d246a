"""Fingers of several segments from the maps of one each: plates are rigid, so that one segment's plate clamps the next.

From tip to base: a map says where its plate is, seen from the plate before. What that plate bears is its own wrench and
the one that the next plate bears, moved there, and nothing else: a long tendon slides through a plate, and enters the
maps of the segments it passes as if it ended at their plates. From base to tip the poses follow each other. (Such a
march is a nonlinear transfer-matrix method.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from rom.checked_file import ModelError
from rom.segment.segment_map import Placed, SegmentMap


class ChainPlaced(NamedTuple):
    """Where the n plates of a chain are, from clamp to tip.

    Attributes:
        centres: shape (n, 3) [m].
        rotations: of their frames, shape (n, 3, 3) [-].
        motions: R^T dc and R^T dtheta of every plate by the inputs, shape (n, 6, t + 6 n) [m, rad per N, N m].
        inside: whether every segment's inputs lie in its trained box.
    """

    centres: np.ndarray
    rotations: np.ndarray
    motions: np.ndarray
    inside: bool


@dataclass(frozen=True)
class Chain:
    """Segments from clamp to tip.

    Args:
        segments: their maps. A tendon that ends at a later segment's plate is one of every segment before, by its name.

    Raises:
        ModelError: a segment does not know a tendon that passes it, or they differ in section or range of tensions.
    """

    segments: Sequence[SegmentMap]

    def __post_init__(self) -> None:
        if not self.segments:
            raise ModelError("segments must be at least one, got none")
        for before, after in zip(self.segments, self.segments[1:], strict=False):
            known = {one["name"]: one for one in _tensions(before)}
            for one in _tensions(after):
                if known.get(one["name"]) != one:
                    raise ModelError(f"segments must know every tendon that passes them, alike, got none {one['name']}")
            if not np.allclose(before.half_lengths, after.half_lengths):
                raise ModelError("segments must have plates of one size, got others")

    @property
    def tensions(self) -> list[str]:
        """Names of the tensions: those of the first segment."""
        return [one["name"] for one in _tensions(self.segments[0])]

    def place(self, tensions: ArrayLike, wrenches: ArrayLike | None = None) -> ChainPlaced:
        """Where the plates are.

        Args:
            tensions: shape (t,) [N].
            wrenches: on the plates in their own frames, shape (n, 6) [N, N m]; none if left out.

        Raises:
            ModelError: the wrong number of tensions or wrenches.
        """
        names, n = self.tensions, len(self.segments)
        pulled, t = np.asarray(tensions, float), len(names)
        pressed = np.zeros((n, 6)) if wrenches is None else np.asarray(wrenches, float)
        if pulled.shape != (t,) or pressed.shape != (n, 6):
            raise ModelError(f"inputs must be {t} tensions and wrenches of shape ({n}, 6), got {pulled.shape}")
        steps, borne, by_inputs = [], np.zeros(6), np.zeros((6, t + 6 * n))
        for k in reversed(range(n)):
            borne, by_inputs = borne + pressed[k], by_inputs.copy()
            by_inputs[:, t + 6 * k : t + 6 * k + 6] += np.eye(6)
            step = self._step(k, pulled, borne, by_inputs)
            steps.append(step)
            borne, by_inputs = step.passed_on, step.passed_on_by_inputs
        return self._poses(steps[::-1])

    def _step(self, k: int, pulled: np.ndarray, borne: np.ndarray, by_inputs: np.ndarray) -> _Step:
        """Segment k under what its plate bears, shape (6,), which changes by the inputs, shape (6, inputs)."""
        segment = self.segments[k]
        own = [self.tensions.index(one["name"]) for one in _tensions(segment)]
        placed = segment.place(np.concatenate([pulled[own], borne]))
        motion = placed.motion[:, len(own) :] @ by_inputs
        motion[:, own] += placed.motion[:, : len(own)]
        arm = placed.centre.copy()  # from the plate before, whose centre lies half a plate before the clamp
        arm[0] += segment.half_lengths[0] if k else 0.0
        force, moment = placed.rotation @ borne[:3], placed.rotation @ borne[3:]
        turned, moved = placed.rotation @ motion[3:], placed.rotation @ motion[:3]
        force_by = placed.rotation @ by_inputs[:3] + np.cross(turned.T, force).T
        moment_by = placed.rotation @ by_inputs[3:] + np.cross(turned.T, moment).T
        moment_by += np.cross(moved.T, force).T + np.cross(arm, force_by.T).T
        return _Step(
            placed=placed,
            arm=arm,
            motion=motion,
            passed_on=np.concatenate([force, moment + np.cross(arm, force)]),
            passed_on_by_inputs=np.concatenate([force_by, moment_by]),
        )

    @staticmethod
    def _poses(steps: list[_Step]) -> ChainPlaced:
        """Poses in space, from those of every plate seen from the one before."""
        centre, rotation, motion = np.zeros(3), np.eye(3), np.zeros_like(steps[0].motion)
        found = []
        for step in steps:
            relative = step.placed.rotation.T
            carried = motion[:3] + np.cross(motion[3:].T, step.arm).T
            motion = np.concatenate([relative @ carried, relative @ motion[3:]]) + step.motion
            centre, rotation = centre + rotation @ step.arm, rotation @ step.placed.rotation
            found.append((centre, rotation, motion))
        centres, rotations, motions = (np.array(part) for part in zip(*found, strict=True))
        return ChainPlaced(centres, rotations, motions, all(bool(step.placed.inside) for step in steps))


class _Step(NamedTuple):
    """One segment of a chain, seen from the plate before.

    Attributes:
        placed: its plate from its own clamp.
        arm: its plate's centre from the centre of the plate before, or from the clamp, shape (3,) [m].
        motion: of its plate relative to the plate before, by the inputs, shape (6, inputs).
        passed_on: the wrench that the plate before bears of it, in that one's frame, shape (6,).
        passed_on_by_inputs: shape (6, inputs).
    """

    placed: Placed
    arm: np.ndarray
    motion: np.ndarray
    passed_on: np.ndarray
    passed_on_by_inputs: np.ndarray


def _tensions(segment: SegmentMap) -> list[dict]:
    """Name, unit, lower and upper of its tensions."""
    return segment.parameters[: segment.tensions]
