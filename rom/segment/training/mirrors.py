"""Mirrors and turns of the section that map a segment onto itself: every state that was solved is several.

Of a map S of space that keeps the axis, with det S = -1 for a mirror, forces and places go with S, and moments and
turns, which are axial vectors, with det(S) S.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from itertools import product
from typing import Any

import numpy as np
from scipy.linalg import block_diag

from rom.brief import brief
from rom.snapshots.grid import SHARE
from rom.snapshots.pressed_states import PressedStates


@brief
@dataclass(frozen=True, kw_only=True)
class Mirror:
    """A map of a segment onto itself: x -> inputs @ x of tensions and wrench, y -> pose @ y of the pose.

    Attributes:
        inputs: orthogonal, shape (t + 6, t + 6).
        pose: orthogonal, shape (7, 7).
    """

    inputs: np.ndarray
    pose: np.ndarray

    def of(self, states: PressedStates) -> PressedStates:
        """The states' images, their poses alone."""
        return replace(
            states.poses_alone(),
            inputs=states.inputs @ self.inputs.T,
            poses=states.poses @ self.pose.T,
            jacobians=self.pose @ states.jacobians @ self.inputs.T,
        )


def mirrors(scene: dict[str, Any]) -> list[Mirror]:
    """Of a segment of square section, all that exchange tendons alike; the identity is left out."""
    return [found for S in _square()[1:] if (found := _of_section(S, scene["tendons"])) is not None]


def _square() -> list[np.ndarray]:
    """The maps of a square onto itself, shapes (2, 2), the identity first."""
    signs = [np.diag(pair) for pair in product((1.0, -1.0), repeat=2)]
    return [*signs, *(sign[:, ::-1] for sign in signs)]


def _of_section(S: np.ndarray, tendons: list[dict[str, Any]]) -> Mirror | None:
    """The mirror by a map of the section, if it takes every tendon to one of the same range and path."""
    exchange = np.zeros((len(tendons), len(tendons)))
    near = SHARE * np.max(np.abs([tendon["offset"] for tendon in tendons]))
    for k, tendon in enumerate(tendons):
        there = S @ tendon["offset"]
        for j, other in enumerate(tendons):
            alike = all(tendon[key] == other[key] for key in ("tension", "path", "segment"))
            exchange[j, k] = alike and np.allclose(there, other["offset"], rtol=0, atol=near)
    if not (exchange.sum(axis=0) == 1).all():
        return None
    polar = block_diag(1.0, S)
    axial = np.linalg.det(S) * polar
    return Mirror(inputs=block_diag(exchange, polar, axial), pose=block_diag(polar, 1.0, axial))


def with_images(states: PressedStates, scene: dict[str, Any]) -> PressedStates:
    """The states and their images, those of a state in its line; their poses alone."""
    parts = [states.poses_alone(), *(mirror.of(states) for mirror in mirrors(scene))]
    return PressedStates(
        **{one.name: np.concatenate([getattr(part, one.name) for part in parts]) for one in fields(PressedStates)}
    )
