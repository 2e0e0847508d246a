"""Mirrors and turns of the section that map a finger's mesh onto itself: every sample of an element has images.

A map S of space keeps the axis; det S is -1 for a mirror. Forces and positions go with S, and moments and rotations,
which are axial vectors, with det(S) S.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
from scipy.linalg import block_diag
from scipy.spatial import cKDTree

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


def mirrors(scene: Mapping[str, Any], nodes: np.ndarray | None = None) -> list[Mirror]:
    """Maps of a square that exchange nodes, tendons of one range and path, and chambers of one span and range.

    They also exchange rectangles of one material. The identity is left out, and so is all with a material in a group.

    Args:
        scene: with the tendons, chambers and materials.
        nodes: of a section's mesh, y and z, shape (nodes, 2) [m]; a square's if None.
    """
    signs = [np.diag(pair) for pair in product((1.0, -1.0), repeat=2)]
    maps = [*signs, *(sign[:, ::-1] for sign in signs)][1:]
    if nodes is not None:
        near, tree = SHARE * np.abs(nodes).max(), cKDTree(nodes)
        maps = [S for S in maps if tree.query(nodes @ S.T)[0].max() < near]
    blocks = [one for one in scene.get("materials") or [] if one["region"] != "section"]
    if any(one["region"] == "group" for one in blocks):
        return []
    maps = [S for S in maps if _exchanges(S, blocks, [one["material"] for one in blocks])[1]]
    return [
        mirror for S in maps if (mirror := _of_section(S, scene["tendons"], scene.get("chambers") or [])) is not None
    ]


def _exchanges(S: np.ndarray, blocks: list[dict[str, Any]], kinds: Sequence[Any]) -> tuple[np.ndarray, bool]:
    """Images of rectangles, as rows, and a flag: each becomes one of its kind and size."""
    exchange = _exchange(S, [one["centre"] for one in blocks], kinds)
    sizes = np.array([one["size"] for one in blocks]).reshape(-1, 2)
    one_each = bool((exchange.sum(axis=0) == 1).all())
    return exchange, one_each and np.allclose(exchange.T @ sizes, sizes @ np.abs(S), rtol=SHARE, atol=0)


def _of_section(S: np.ndarray, tendons: list[dict[str, Any]], chambers: list[dict[str, Any]]) -> Mirror | None:
    """The mirror by a map of the section, if it takes every tendon and every chamber to one like it."""
    pulled = _exchange(
        S, [one["offset"] for one in tendons], [(one["tension"], one["path"], one["segment"]) for one in tendons]
    )
    pushed, alike = _exchanges(S, chambers, [(one["x"], one["pressure"]) for one in chambers])
    exchange = block_diag(pulled, pushed) if chambers else pulled
    if not alike or not (pulled.sum(axis=0) == 1).all():
        return None
    polar = block_diag(1.0, S)
    axial = np.linalg.det(S) * polar
    return Mirror(inputs=block_diag(exchange, polar, axial), values=block_diag(polar, axial, exchange), section=S)


def _exchange(S: np.ndarray, places: Sequence[Sequence[float]], kinds: Sequence[tuple]) -> np.ndarray:
    """Images of actuators, as rows: those at the mapped position that are of its kind, shape (k, k)."""
    at = np.array(places, float).reshape(-1, 2)
    apart = np.abs(at[:, None] - at @ S.T).max(axis=2, initial=0.0)
    alike = np.array([[one == other for other in kinds] for one in kinds], bool).reshape(apart.shape)
    return (alike & (apart <= SHARE * np.abs(at).max(initial=0.0))).astype(float)
