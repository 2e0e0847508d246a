"""Keyframes of a model with attached fingers: they keep their coordinates, and fingers rest in them."""

from __future__ import annotations

from typing import NamedTuple

import mujoco
import numpy as np

WIDTHS = {"FREE": (7, 6), "BALL": (4, 3), "SLIDE": (1, 1), "HINGE": (1, 1)}  # coordinates and velocities of a joint


class Sizes(NamedTuple):
    """Numbers of coordinates and of velocities."""

    coordinates: int
    velocities: int


def sizes(spec: mujoco.MjSpec, before: str | None = None) -> Sizes:
    """Count those of a model, or of its bodies before a named one in the order of compilation."""
    found, waiting = np.zeros(2, int), [spec.worldbody]
    while waiting and waiting[-1].name != before:
        body = waiting.pop()
        found += [sum(WIDTHS[one.type.name.removeprefix("mjJNT_")][k] for one in body.joints) for k in (0, 1)]
        waiting += list(body.bodies)[::-1]
    return Sizes(*found.tolist())


def check(spec: mujoco.MjSpec) -> None:
    """Check keyframes before a finger is attached.

    Raises:
        ValueError: a keyframe whose numbers of coordinates differ from those of the model.
    """
    nq, nv = sizes(spec)
    for key in spec.keys:
        for name, count, own in (("qpos", nq, key.qpos), ("qvel", nv, key.qvel)):
            if len(own) not in (0, count):
                raise ValueError(f"{name} of keyframe {key.name!r} must have {count} numbers, got {len(own)}")


def insert(spec: mujoco.MjSpec, clamp: str, sections: int) -> None:
    """Insert the coordinates of a finger at rest into keyframes that were complete without it."""
    at = sizes(spec, before=clamp)
    rest = np.tile([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], sections)
    for key in spec.keys:
        if len(key.qpos):
            key.qpos = np.insert(np.array(key.qpos), at.coordinates, rest)
        if len(key.qvel):
            key.qvel = np.insert(np.array(key.qvel), at.velocities, np.zeros(6 * sections))
