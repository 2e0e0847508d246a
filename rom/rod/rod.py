"""A finger assembled from elements: poses of its plates under tensions and wrenches, and its file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np
from numpy.typing import ArrayLike

from rom.brief import brief
from rom.console.table import Table, as_html
from rom.dataset.actuators import actuators_of
from rom.dataset.geometry import tip_at_rest
from rom.elements.elements import Elements
from rom.elements.limits import check as check_elements
from rom.elements.pieces import Piece
from rom.files import checked_file
from rom.files.checked_file import ModelError
from rom.native import PickledByFields
from rom.parameter import Parameter
from rom.rod import compiled, shape
from rom.rod.chain_of_rod import QUANTITIES as QUANTITIES
from rom.rod.chain_of_rod import chain_of
from rom.rod.compiled import reports
from rom.rod.expected_errors import ExpectedErrors, errors_of
from rom.rod.limits import check as check_rod
from rom.rod.scene.intervals_of_rod import pieces_of
from rom.rod.scene.scene_of_rod import Similarity, completed, of_tables, passing, read_scene, similarity
from rom.rod.segment import Segment, segment_of
from rom.rod.tables import summary
from rom.rod.weight import turned

KIND, FORMAT, PLAIN = "fingerfem rod", 2, ("scene", "accuracy", "calibration")


@brief
class Plates(NamedTuple):
    """Poses of the n plates of a finger, from clamp to tip.

    Attributes:
        centres: shape (n, 3) [m].
        rotations: of their frames, shape (n, 3, 3) [-].
        motions: R^T dc and R^T dtheta of every plate, derivatives with respect to the tensions and wrenches, shape
            (n, 6, t + 6 n) [m, rad per N, N m].
        inside: whether tensions and wrench of every element are within its trained domain.
    """

    centres: np.ndarray
    rotations: np.ndarray
    motions: np.ndarray
    inside: bool


@brief
@dataclass(frozen=True, kw_only=True)
class Rod(PickledByFields):
    """Segments of elements from clamp to tip, each with a plate that clamps the next.

    Attributes:
        elements: the elements as trained.
        scene: of the finger: geometry, material and tendons, as plain data.
        accuracy: errors measured on held-out states; empty if not measured.
        calibration: the log and its result (`control.calibrate`); empty if not calibrated.
        parts: into which interior elements are cut, for the mass of a moving finger; answers at rest hardly change.

    Raises:
        ModelError: the elements cannot make this finger; the message says what is missing.

    Example:
        >>> Rod.load("finger.h5").assembled("longer.toml").place([30.0, 0.0]).centres[-1]  # doctest: +SKIP
    """

    elements: Elements
    scene: dict[str, Any]
    accuracy: dict[str, Any] = field(default_factory=dict)
    calibration: dict[str, Any] = field(default_factory=dict)
    parts: int = 1

    def __post_init__(self) -> None:
        self.segments  # refuses what cannot be made  # noqa: B018

    @cached_property
    def similarity(self) -> Similarity:
        """The scaling of the elements, and which of their tendons are this finger's."""
        return similarity(self.elements.scene, self.scene)

    @cached_property
    def own(self) -> Elements:
        """The elements at this finger's size and modulus."""
        return self.elements.scaled(self.similarity.size, self.similarity.modulus)

    @cached_property
    def _scaled(self) -> dict[tuple[float, float], Elements]:
        """The elements by size over that of a finger without taper, and modulus over that of the rubber [-]."""
        scales = {(piece.size, piece.modulus) for own in self.pieces for piece in own}
        return {one: self.own if one == (1, 1) else self.own.scaled(*one) for one in scales}

    def scaled(self, piece: Piece) -> Elements:
        """The elements at the size and modulus of one of this finger's pieces."""
        return self._scaled[piece.size, piece.modulus]

    @cached_property
    def pieces(self) -> list[list[Piece]]:
        """The elements of every segment, from its plate to its clamp."""
        lengths = {kind: law.lengths for kind, law in self.own.laws.items()}
        return pieces_of(lengths, self.scene["geometry"], self.similarity.intervals, self.parts)

    @cached_property
    def segments(self) -> list[Segment]:
        """Segments from clamp to tip; a tendon passes all segments up to its plate, a chamber is in one."""
        scenes = self.elements.scene, self.scene, self.similarity
        return [segment_of(self.own, own, *passing(*scenes, k)) for k, own in enumerate(self.pieces)]

    @property
    def parameters(self) -> list[Parameter]:
        """The tensions, then the pressures."""
        return [Parameter(one.name, one.unit, one.lower, one.upper) for one in actuators_of(self.scene)]

    @property
    def names(self) -> list[str]:
        """Names of the tensions, then of the pressures."""
        return [one.name for one in actuators_of(self.scene)]

    @property
    def half_lengths(self) -> np.ndarray:
        """Half lengths of the tip plate along its own axes, shape (3,) [m]; without taper, all plates have the same."""
        return self.segments[-1].half_lengths

    @property
    def rest(self) -> np.ndarray:
        """The tip plate's centre in the undeformed finger, shape (3,) [m]."""
        return tip_at_rest(self.scene["geometry"])

    @property
    def force(self) -> float:
        """Largest contact force that the elements were trained with [N]."""
        return self.own.force

    @cached_property
    def errors(self) -> ExpectedErrors:
        """The expected errors, from lines left out of the training; at least those on the log of a calibration."""
        return errors_of(self)

    @cached_property
    def struct(self) -> Any:
        """The struct fingerfem_chain for compiled code, see `chain_of`."""
        return chain_of(self)

    def place(self, tensions: ArrayLike, wrenches: ArrayLike | None = None) -> Plates:
        """Poses of the plates.

        Args:
            tensions: of the tendons [N], then pressures of the chambers [Pa], shape (t,).
            wrenches: on the plates in their own frames, shape (n, 6) [N, N m]; none if omitted.

        Raises:
            ModelError: the wrong number of tensions and pressures, or of wrenches.
        """
        return Plates(*compiled.place_chain(self.struct, *self._inputs(tensions, wrenches)))

    def _inputs(self, tensions: ArrayLike, wrenches: ArrayLike | None) -> tuple[np.ndarray, np.ndarray]:
        """Tensions and wrenches of `place` as arrays; loads of an answer, one per element, are taken unchanged."""
        t, n = len(self.names), len(self.segments)
        pulled = np.array(tensions, float)
        pressed = np.zeros((n, 6)) if wrenches is None else np.array(wrenches, float)
        if pulled.shape != (t,) or pressed.shape not in ((n, 6), (6 * sum(map(len, self.pieces)),)):
            shapes = f"{pulled.shape} and {pressed.shape}"
            raise ModelError(f"inputs must be {t} tensions and wrenches of shape ({n}, 6), got shapes {shapes}")
        return pulled, pressed

    def shortening(self, tensions: ArrayLike, wrenches: ArrayLike | None = None) -> np.ndarray:
        """Shortening of the tendons between clamp and plate, shape (tendons,) [m]; arguments of `place`."""
        return self.strokes(tensions, wrenches)[: len(self.scene["tendons"])]

    def growth(self, tensions: ArrayLike, wrenches: ArrayLike | None = None) -> np.ndarray:
        """Growth of the chambers' volumes, shape (chambers,) [m^3]; arguments of `place`."""
        return self.strokes(tensions, wrenches)[len(self.scene["tendons"]) :]

    def strokes(self, tensions: ArrayLike, wrenches: ArrayLike | None = None) -> np.ndarray:
        """Strokes that loads do work on: shortenings, then growths, shape (t,) [m, m^3]; arguments of `place`."""
        return reports.shortenings(self.struct, *self._inputs(tensions, wrenches))[0]

    def displacement(
        self, tensions: ArrayLike, wrenches: ArrayLike | None = None, points: ArrayLike | None = None
    ) -> np.ndarray:
        """Displacement of material points, shape (points, 3) [m].

        Args:
            tensions: shape (t,) [N].
            wrenches: on the plates in their own frames, shape (n, 6) [N, N m]; none if omitted.
            points: at rest, shape (points, 3) [m]; by default those of the long edges, see `edges`.

        Raises:
            ModelError: the wrong number of tensions or wrenches, or a point outside the finger.
        """
        at_rest = self.edges if points is None else np.asarray(points, float)
        return shape.displacements(self, shape.placed(self, *self._inputs(tensions, wrenches)), at_rest)

    def sections(
        self, tensions: ArrayLike, wrenches: ArrayLike | None = None, at: ArrayLike | None = None
    ) -> shape.Sections:
        """The poses of cross-sections: the shape of the finger's axis.

        Args:
            tensions: shape (t,) [N].
            wrenches: on the plates in their own frames, shape (n, 6) [N, N m]; none if omitted.
            at: positions along the finger at rest, measured from the clamp, shape (m,) [m]; by default half a side
                apart, as `edges`.

        Raises:
            ModelError: the wrong number of tensions or wrenches, or a position outside the finger.

        Example:
            >>> Rod.load("finger.h5").sections([30.0, 0.0], at=[0.02, 0.04]).rotations  # doctest: +SKIP
        """
        distances = np.unique(self.edges[:, 0]) if at is None else np.atleast_1d(np.asarray(at, float))
        return shape.sections(self, shape.placed(self, *self._inputs(tensions, wrenches)), distances)

    @property
    def edges(self) -> np.ndarray:
        """Points on the long edges at evenly spaced cross-sections, shape (points, 3) [m]."""
        return shape.edges(self)

    def assembled(self, scene: str | Path | Mapping[str, Any]) -> Rod:
        """The finger of another scene, assembled from these elements.

        Args:
            scene: its TOML file, or its tables.

        Raises:
            ModelError: not a valid scene, or the elements cannot make it; the message says what is missing.
        """
        tables = of_tables(scene) if isinstance(scene, Mapping) else read_scene(scene)
        return Rod(elements=self.elements, scene=completed(tables, self.elements.scene))

    def with_gravity(self, direction: ArrayLike, acceleration: float | None = None) -> Rod:
        """The same finger on a turned base; the compiled data of its segments are shared.

        Args:
            direction: of the weight in the clamp's frame, shape (3,) [-].
            acceleration: [m/s^2]; unchanged by default.

        Raises:
            ModelError: the scene has no [gravity], or the direction is zero or not finite.
        """
        rod, scene = copy(self), turned(self.scene, np.asarray(direction, float).tolist(), acceleration)
        vars(rod).update({name: one for name, one in vars(self).items() if name != "struct"} | {"scene": scene})
        return rod

    def with_accuracy(self, accuracy: dict[str, Any]) -> Rod:
        """The same finger with its measured errors."""
        return replace(self, accuracy=accuracy)

    def tables(self) -> list[Table | str]:
        """Readable tables of its segments and tendons, and of errors in lines left out of the training."""
        return summary.tables(self)

    def _repr_html_(self) -> str:
        return as_html(self.tables())

    def save(self, path: str | Path) -> None:
        """Write the finger and its elements; an interruption never leaves an incomplete file."""
        checked_file.save(Path(path), KIND, FORMAT, self._write)

    def _write(self, file: h5py.File) -> None:
        file.attrs.update({name: json.dumps(getattr(self, name)) for name in PLAIN})
        self.elements.write(file.create_group("elements"))

    @classmethod
    def load(cls, path: str | Path) -> Rod:
        """Read a finger.

        Raises:
            ModelError: the file is missing, damaged, not a rod, or has another format.
        """
        return checked_file.load(Path(path), KIND, FORMAT, cls._read)

    @classmethod
    def _read(cls, file: h5py.File) -> Rod:
        plain = {name: json.loads(file.attrs.get(name, "{}")) for name in PLAIN}
        plain["scene"] = plain["scene"] | of_tables(plain["scene"])
        elements = Elements.read(file["elements"])
        check_elements(elements)
        check_rod(rod := cls(elements=elements, **plain))
        return rod
