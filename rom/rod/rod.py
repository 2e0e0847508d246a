"""A finger assembled from elements: where its plates are under tensions and wrenches; and its file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np
from numpy.typing import ArrayLike

from rom import checked_file
from rom.brief import brief
from rom.checked_file import ModelError
from rom.elements.elements import Elements
from rom.elements.law import ElementMap
from rom.elements.march import march
from rom.elements.pieces import Piece, pieces
from rom.rod.scene_of_rod import Similarity, of_tables, read_scene, similarity
from rom.snapshots.grid import SHARE
from rom.table import Table, as_html, parameters, percent

KIND, FORMAT = "fingerfem rod", 1


@brief
class Plates(NamedTuple):
    """Where the plates of a finger are, n states; shapes without n at one.

    Attributes:
        centres: from clamp to tip, shape (n, plates, 3) [m].
        rotations: of their frames, shape (n, plates, 3, 3) [-].
        inside: whether the inputs of every element lie in its box, shape (n,).
    """

    centres: np.ndarray
    rotations: np.ndarray
    inside: np.ndarray


@brief
@dataclass(frozen=True, kw_only=True)
class Rod:
    """Segments of elements from clamp to tip, each with a plate that clamps the next.

    Attributes:
        elements: as they were trained.
        scene: of the finger: geometry, material and tendons, as plain data.

    Raises:
        ModelError: the elements cannot make this finger: what is missing.

    Example:
        >>> finger = Rod.load("finger.h5").assembled("longer.toml")  # doctest: +SKIP
        >>> finger.place([30.0, 0.0]).centres[-1]  # doctest: +SKIP
    """

    elements: Elements
    scene: dict[str, Any]

    def __post_init__(self) -> None:
        self.segments  # refuses what cannot be made  # noqa: B018

    @cached_property
    def similarity(self) -> Similarity:
        """How the elements are scaled, and which of their tendons are this finger's."""
        return similarity(self.elements.scene, self.scene)

    @cached_property
    def own(self) -> Elements:
        """The elements at this finger's size and modulus."""
        return self.elements.scaled(self.similarity.size, self.similarity.modulus)

    @cached_property
    def pieces(self) -> list[list[Piece]]:
        """The elements of every segment, from its plate to its clamp."""
        geometry = self.scene["geometry"]
        lengths, found = {kind: law.lengths for kind, law in self.own.laws.items()}, []
        for k, length in enumerate(geometry["segments"]):
            try:
                found.append(pieces(lengths, length - geometry["plate"] / 2))
            except ModelError as error:
                raise ModelError(f"geometry.segments.{k}: {error}") from None
        return found

    @cached_property
    def segments(self) -> list[list[ElementMap]]:
        """The maps of these, one object for all pieces of a kind and length."""
        laws: dict[Piece, ElementMap] = {}
        for piece in {one for segment in self.pieces for one in segment}:
            laws[piece] = self.own.laws[piece.kind].of_length(piece.length)
        return [[laws[piece] for piece in segment] for segment in self.pieces]

    @property
    def parameters(self) -> list[dict[str, Any]]:
        """Name, unit, lower and upper of the tensions."""
        return [
            {"name": one["name"], "unit": "N", "lower": one["tension"][0], "upper": one["tension"][1]}
            for one in self.scene["tendons"]
        ]

    @property
    def names(self) -> list[str]:
        """Of the tendons."""
        return [one["name"] for one in self.scene["tendons"]]

    @property
    def half_lengths(self) -> np.ndarray:
        """Of every plate along its own axes, shape (3,) [m]."""
        geometry = self.scene["geometry"]
        return np.array([geometry["plate"], geometry["side"], geometry["side"]]) / 2

    @property
    def rest(self) -> np.ndarray:
        """The tip plate's centre in the undeformed finger, shape (3,) [m]."""
        return np.array([sum(self.scene["geometry"]["segments"]) - self.half_lengths[0], 0.0, 0.0])

    def of_segment(self, k: int, tensions: np.ndarray) -> np.ndarray:
        """The elements' tensions in segment k, shape (n, trained tendons): zero where no tendon passes [N]."""
        found = np.zeros((len(tensions), self.elements.tensions))
        for tendon, own, tension in zip(self.scene["tendons"], self.similarity.tendons, tensions.T, strict=True):
            if tendon["segment"] > k:
                found[:, own] += tension
        return found

    def place(self, tensions: ArrayLike, wrenches: ArrayLike | None = None) -> Plates:
        """Where the plates are.

        Args:
            tensions: shape (t,) or (n, t) [N].
            wrenches: on the plates in their own frames, shape (plates, 6) or (n, plates, 6) [N, N m]; none if omitted.

        Raises:
            ModelError: the wrong number of tensions or wrenches.
        """
        pulled, count = np.atleast_2d(np.asarray(tensions, float)), len(self.segments)
        pressed = np.asarray(np.zeros((len(pulled), count, 6)) if wrenches is None else wrenches, float)
        own = pressed.shape
        pressed = pressed[None] if pressed.ndim == 2 else pressed
        if pulled.shape[1] != len(self.names) or pressed.shape != (len(pulled), count, 6):
            raise ModelError(
                f"inputs must be {len(self.names)} tensions and wrenches of shape ({count}, 6), "
                f"got shapes {np.shape(tensions)} and {own}"
            )
        ahead, wrench = self.half_lengths[0], np.zeros((len(pulled), 6))
        limits = np.array([[one["lower"], one["upper"]] for one in self.parameters])
        inside, relative = np.all((pulled >= limits[:, 0]) & (pulled <= limits[:, 1]), axis=1), []
        for k in reversed(range(count)):
            wrench = pressed[:, k] + wrench
            inside &= np.linalg.norm(wrench[:, :3], axis=1) <= self.own.force
            marched = march(self.segments[k], self.of_segment(k, pulled), wrench)
            inside &= marched.inside
            relative.append(marched.plate)
            wrench = marched.base
            wrench[:, 3:] += np.cross([ahead, 0.0, 0.0], wrench[:, :3])  # about the centre of the plate that clamps it
        centres, rotations = [], []
        centre, rotation = np.zeros((len(pulled), 3)), np.tile(np.eye(3), (len(pulled), 1, 1))
        for arm, turned in reversed(relative):
            centre = centre + np.einsum("nij,nj->ni", rotation, arm)
            rotation = rotation @ turned
            centres.append(centre)
            rotations.append(rotation)
            centre = centre + ahead * rotation[:, :, 0]
        found = Plates(np.stack(centres, axis=1), np.stack(rotations, axis=1), inside)
        return found if np.ndim(tensions) > 1 else Plates(*(part[0] for part in found))

    def assembled(self, scene: str | Path | Mapping[str, Any]) -> Rod:
        """The finger of another scene, of these elements.

        Args:
            scene: its TOML file, or its tables.

        Raises:
            ModelError: no scene, or these elements cannot make it: what is missing.
        """
        tables = of_tables(scene) if isinstance(scene, Mapping) else read_scene(scene)
        return Rod(elements=self.elements, scene=self.elements.scene | tables)

    def tables(self) -> list[Table | str]:
        """For people: its segments, tendons, and how well its elements predict what was left out."""
        left_out = self.elements.provenance["left_out"]
        rows = [
            [str(k + 1), f"{1e3 * length:g}", ", ".join(kind for kind, _ in reversed(own))]
            for k, (length, own) in enumerate(zip(self.scene["geometry"]["segments"], self.pieces, strict=True))
        ]
        force, free = left_out["contact_force"], left_out["free_place_m"]
        return [
            f"{self.scene['name']}: a rod of {sum(map(len, self.pieces))} elements, "
            f"trained on {self.elements.scene['name']}"
            + "".join(
                f", {name} x {factor:g}"
                for name, factor in zip(("size", "modulus"), self.similarity[:2], strict=True)
                if abs(factor - 1) > SHARE
            ),
            Table(header=["segment", "length [mm]", "elements from the clamp"], rows=rows),
            parameters(self.parameters),
            f"lines left out of the training: contact force within {percent(force['p95'])} (95 %), "
            f"median {percent(force['median'])}; free tip within {1e6 * free['p95']:.3g} µm",
        ]

    def _repr_html_(self) -> str:
        return as_html(self.tables())

    def save(self, path: str | Path) -> None:
        """Write the finger and its elements: the file is whole or absent."""
        checked_file.save(Path(path), KIND, FORMAT, self._write)

    def _write(self, file: h5py.File) -> None:
        file.attrs["scene"] = json.dumps(self.scene)
        self.elements.write(file.create_group("elements"))

    @classmethod
    def load(cls, path: str | Path) -> Rod:
        """Read a finger.

        Raises:
            ModelError: no file, no rod, a damaged one, or one of another format.
        """
        return checked_file.load(Path(path), KIND, FORMAT, cls._read)

    @classmethod
    def _read(cls, file: h5py.File) -> Rod:
        return cls(elements=Elements.read(file["elements"]), scene=json.loads(file.attrs["scene"]))
