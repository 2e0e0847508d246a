"""The compiled map of a segment and what touches it (native/segment.h), called with arrays of NumPy."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from rom.native import Library
from rom.segment.segment_map import SegmentMap

HERE = Path(__file__).parent / "native"
BLOCK, POSE = 4, 8  # as in segment.h
UNITS = [HERE / name for name in ("map.c", "objects.c", "small.c", "touch.c")]
SEGMENT = Library("segment", headers=[HERE / "segment.h"], units=UNITS)


def pointer(array: np.ndarray, kind: str = "double[]") -> Any:
    """Where the numbers of a contiguous array of NumPy are."""
    return SEGMENT.ffi.from_buffer(kind, array)


def struct(segment: SegmentMap) -> Any:
    """A map as a struct fingerfem_segment."""
    t, geometry = segment.tensions, segment.scene["geometry"]
    monomials, groups, coefficients = _arranged(segment.pose.powers, segment.pose.coefficients, t)
    variables = np.array([max(np.flatnonzero(group), default=0) for group in groups])
    rows = np.arange(len(groups))
    without = groups.copy()
    without[rows, variables] = 0
    blocks = coefficients.reshape(-1, BLOCK, len(monomials), POSE)
    used = [int(np.flatnonzero(block.any(axis=(0, 2))).max(initial=0)) + 1 for block in blocks]
    return SEGMENT.struct(
        "fingerfem_segment",
        tensions=t,
        groups=len(groups),
        monomials=len(monomials),
        lower=segment.pose.lower,
        upper=segment.pose.upper,
        tension_powers=monomials,
        block_monomials=np.array(used),
        coefficients=np.concatenate([b[:, :n].swapaxes(0, 1).ravel() for b, n in zip(blocks, used, strict=True)]),
        parents=(groups[None] == without[:, None]).all(axis=2).argmax(axis=1),
        variables=variables,
        powers=groups[rows, variables],
        half_lengths=segment.half_lengths.tolist(),
        rest=[sum(geometry["segments"]) - geometry["plate"] / 2, 0.0, 0.0],
    )


def _arranged(powers: np.ndarray, values: np.ndarray, t: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Powers, shape (k, t + 6), and coefficients, shape (k, 7), in the order of segment.h.

    Returns:
        monomials of the tensions, shape (monomials, t); powers of the wrench, shape (groups, 6), those with most
        monomials first, so that a parent stands before its groups; coefficients, shape (groups, monomials, 8).
    """
    monomials = sorted({tuple(row) for row in powers[:, :t].tolist()}, key=lambda row: (sum(row), row))
    counts = Counter(tuple(row) for row in powers[:, t:].tolist())
    groups = sorted(counts, key=lambda group: (-counts[group], sum(group), group))
    row, column = ({key: k for k, key in enumerate(keys)} for keys in (groups, monomials))
    found = np.zeros((len(groups), len(monomials), POSE))
    for power, coefficients in zip(powers.tolist(), values, strict=True):
        found[row[tuple(power[t:])], column[tuple(power[:t])], : POSE - 1] = coefficients
    fill = -len(groups) % BLOCK  # copies of the first group, of which nothing is taken
    return (
        np.array(monomials),
        np.array(groups + [groups[0]] * fill),
        np.concatenate([found, np.zeros((fill, *found.shape[1:]))]),
    )


def place(compiled: Any, inputs: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
    """Pose, shape (7,), its motion by the inputs, shape (6, t + 6), and whether these, shape (t + 6,), are inside."""
    pose, motion, t = np.empty(8), np.empty((6, len(inputs))), len(inputs) - 6
    inside = SEGMENT.functions.fingerfem_place(
        compiled, pointer(inputs[:t].copy()), pointer(inputs[t:].copy()), pointer(pose), pointer(motion)
    )
    return pose[:7], motion, bool(inside)


def touch(touching: Any, point: np.ndarray, wrench: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool, int]:
    """Answer, shape (5,), its derivatives, shape (5, t + 1), whether inside, and evaluations, negative without an answer.

    Args:
        touching: a struct fingerfem_touching.
        point: tensions [N] and d [m], contiguous, shape (t + 1,).
        wrench: where the solve begins and, afterwards, what it ended with, shape (6,) [N, N m].
    """
    out, jacobian, inside = np.empty(5), np.empty((5, len(point))), np.empty(1, np.int32)
    evaluations = SEGMENT.functions.fingerfem_touch(
        touching, pointer(point), pointer(wrench), pointer(out), pointer(jacobian), pointer(inside, "int32_t[]")
    )
    return out, jacobian, bool(inside[0]), int(evaluations)
