"""Mirrors and turns of the section that map a finger onto itself: every sample of an element has images.

Of a map S of space that keeps the axis, with det S = -1 for a mirror, forces and places go with S, and moments and
turns, which are axial vectors, with det(S) S.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
from scipy.linalg import block_diag

from rom.brief import brief
from rom.dataset.grid import SHARE
from rom.elements.samples.tension_map import TensionMap


@brief
@dataclass(frozen=True, kw_only=True)
class Mirror:
    """A map of an element onto itself: x -> inputs @ x of loads and wrench, y -> values @ y of what it does.

    Both are signed permutations.

    Attributes:
        inputs: shape (t + 6, t + 6).
        values: shape (6 + t, 6 + t).
        section: the map of the section that it is, y and z, shape (2, 2).
    """

    inputs: np.ndarray
    values: np.ndarray
    section: np.ndarray

    def combined(self, tension_map: TensionMap) -> Mirror:
        """The same, by combinations of the tensions: a signed permutation of these, as a `TensionMap` has them."""
        t, matrix = len(tension_map.orders), tension_map.matrix
        exchange = np.rint(matrix @ self.inputs[:t, :t] @ matrix.T)
        return replace(self, inputs=block_diag(exchange, self.inputs[t:, t:]))

    def with_length(self) -> Mirror:
        """The same, where the length is one more input."""
        return replace(self, inputs=block_diag(self.inputs, 1.0))


def mirrors(scene: dict[str, Any]) -> list[Mirror]:
    """Of a square section, all that exchange tendons of one range and path, and chambers of one size, span and range.

    The identity is left out.
    """
    chambers = scene.get("chambers") or []
    return [found for S in _square()[1:] if (found := _of_section(S, scene["tendons"], chambers)) is not None]


def _square() -> list[np.ndarray]:
    """The maps of a square onto itself, shapes (2, 2), the identity first."""
    signs = [np.diag(pair) for pair in product((1.0, -1.0), repeat=2)]
    return [*signs, *(sign[:, ::-1] for sign in signs)]


def _of_section(S: np.ndarray, tendons: list[dict[str, Any]], chambers: list[dict[str, Any]]) -> Mirror | None:
    """The mirror by a map of the section, if it takes every tendon and every chamber to one like it."""
    near = SHARE * np.max(np.abs([one["offset"] for one in tendons] + [one["size"] for one in chambers]))
    pulled = _exchange(S, tendons, "offset", lambda one: [one[key] for key in ("tension", "path", "segment")], near)
    turned = np.abs(S)  # what becomes of a rectangle's size
    pushed = _exchange(S, chambers, "centre", lambda one: [*one["x"], *one["pressure"]], near)
    sizes = np.array([one["size"] for one in chambers]).reshape(-1, 2)
    if not ((pulled.sum(axis=0) == 1).all() and (pushed.sum(axis=0) == 1).all()):
        return None
    if not np.allclose(pushed.T @ sizes, sizes @ turned.T, rtol=0, atol=near):
        return None
    exchange = block_diag(pulled, pushed) if chambers else pulled
    polar = block_diag(1.0, S)
    axial = np.linalg.det(S) * polar
    return Mirror(inputs=block_diag(exchange, polar, axial), values=block_diag(polar, axial, exchange), section=S)


def _exchange(
    S: np.ndarray, actuators: list[dict[str, Any]], place: str, alike: Callable[[dict[str, Any]], list], near: float
) -> np.ndarray:
    """Which of actuators, as rows, every one becomes: that at its mapped place, if it is alike; shape (k, k)."""
    found = np.zeros((len(actuators), len(actuators)))
    for k, one in enumerate(actuators):
        there = S @ one[place]
        for j, other in enumerate(actuators):
            found[j, k] = alike(one) == alike(other) and np.allclose(there, other[place], rtol=0, atol=near)
    return found
