"""Fingers of several segments from the maps of one each: plates are rigid, so that one segment's plate clamps the next.

native/chain.c marches through them.
"""

from __future__ import annotations

from collections.abc import Sequence
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
from rom.native import PickledByFields
from rom.segment import native, segment_map
from rom.segment.segment_map import SegmentMap
from rom.snapshots.grid import SHARE
from rom.table import Table, as_html

KIND, FORMAT = "fingerfem chain", 1
KINDS = (segment_map.KIND, KIND)  # of files that `Chain.load` reads
MOST_PLATES = 3  # as in native/segment.h


@brief
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


@brief
@dataclass(frozen=True)
class Chain(PickledByFields):
    """Segments from clamp to tip.

    Args:
        segments: their maps. A tendon that ends at a later segment's plate is one of every segment before, by its name.

    Raises:
        ModelError: a segment does not know a tendon that passes it, they differ in section or range of tensions, or are
            too many.

    Example:
        >>> finger = Chain([SegmentMap.load("base.h5"), SegmentMap.load("tip.h5")])
        >>> finger.place([20.0, 0.0, 10.0, 0.0]).centres[-1]
    """

    segments: Sequence[SegmentMap]

    def __post_init__(self) -> None:
        if not 1 <= len(self.segments) <= MOST_PLATES:
            raise ModelError(f"segments must be at least one and at most {MOST_PLATES}, got {len(self.segments)}")
        for before, after in zip(self.segments, self.segments[1:], strict=False):
            known = {one["name"]: one for one in before.tension_parameters}
            for one in after.tension_parameters:
                if known.get(one["name"]) != one:
                    raise ModelError(f"segments must know every tendon that passes them, alike, got none {one['name']}")
            if not np.allclose(before.half_lengths, after.half_lengths, rtol=SHARE, atol=0):
                raise ModelError("segments must have plates of one size, got others")

    @property
    def tension_parameters(self) -> list[dict[str, Any]]:
        """Name, unit, lower and upper of the tensions: those of the first segment."""
        return self.segments[0].tension_parameters

    @property
    def tensions(self) -> list[str]:
        """Their names."""
        return [one["name"] for one in self.tension_parameters]

    @property
    def half_lengths(self) -> np.ndarray:
        """Of every plate along its own axes, shape (3,) [m]."""
        return self.segments[0].half_lengths

    @property
    def rest(self) -> np.ndarray:
        """The tip plate's centre in the undeformed finger, shape (3,) [m]."""
        lengths = sum(self.scene["geometry"]["segments"])
        return np.array([lengths - self.half_lengths[0], 0.0, 0.0])

    @property
    def force_error(self) -> float:
        """Relative error of contact forces: of the segment that is worst [-]."""
        return max(one.force_error for one in self.segments)

    def finer_mesh_factor(self, quantity: str) -> float:
        """Times how much its estimated error covers what states on a finer mesh showed; 1 if nobody looked [-]."""
        return max(one.finer_mesh_factors.get(quantity, 1.0) for one in self.segments)

    @property
    def place_error(self) -> float:
        """Of the free tip plate [m]: each segment's, and as that one bends besides, by what stands on it."""
        return self._at_tip([one.place_error for one in self.segments])

    @property
    def place_error_by_force(self) -> float:
        """What a contact force adds to that [m/N]."""
        return self._at_tip([one.place_error_by_force for one in self.segments])

    def _at_tip(self, errors: Sequence[float]) -> float:
        """What errors of every segment's place make at the tip plate."""
        lengths = self.scene["geometry"]["segments"]
        shares = [1 + 2 * sum(lengths[k + 1 :]) / length for k, length in enumerate(lengths)]  # a rod of one curvature
        return float(sum(share * error for share, error in zip(shares, errors, strict=True)))

    @property
    def skin_error(self) -> float:
        """Of what is known of the rubber's surface [m]; nan if nothing is."""
        return float(np.fmax.reduce([one.skin_error for one in self.segments]))

    @property
    def scene(self) -> dict[str, Any]:
        """The first segment's, with all segments, and tendons as far as they go."""
        scene = self.segments[0].scene
        last = {
            name: k + 1 for k, one in enumerate(self.segments) for name in (p["name"] for p in one.tension_parameters)
        }
        lengths = [length for one in self.segments for length in one.scene["geometry"]["segments"]]
        tendons = [tendon | {"segment": last[tendon["name"]]} for tendon in scene["tendons"]]
        return scene | {"geometry": scene["geometry"] | {"segments": lengths}, "tendons": tendons}

    @cached_property
    def struct(self) -> Any:
        """For compiled code, a struct fingerfem_chain."""
        own = np.zeros((len(self.segments), len(self.tensions)), int)
        for k, one in enumerate(self.segments):
            own[k, : one.tensions] = [self.tensions.index(name) for name in one.names[: one.tensions]]
        tip, force, touch = map(self.finer_mesh_factor, ("tip", "contact_force", "touch_distance"))
        errors = {
            "tip_error": tip * self.place_error,
            "tip_error_by_force": tip * self.place_error_by_force,
            "force_error": force * self.force_error,
            "force_error_by_place": force * self.place_error,
            "touch_error": touch * self.place_error,
            "touch_error_of_skin": touch * self.skin_error,
        }
        return native.chain_struct([one.struct for one in self.segments], own, self.rest, self.skin_error, errors)

    def place(self, tensions: ArrayLike, wrenches: ArrayLike | None = None) -> ChainPlaced:
        """Where the plates are.

        Args:
            tensions: shape (t,) [N].
            wrenches: on the plates in their own frames, shape (n, 6) [N, N m]; none if left out.

        Raises:
            ModelError: the wrong number of tensions or wrenches.
        """
        t, n = len(self.tensions), len(self.segments)
        pulled = np.array(tensions, float)
        pressed = np.zeros((n, 6)) if wrenches is None else np.array(wrenches, float)
        if pulled.shape != (t,) or pressed.shape != (n, 6):
            raise ModelError(f"inputs must be {t} tensions and wrenches of shape ({n}, 6), got {pulled.shape}")
        return ChainPlaced(*native.place_chain(self.struct, pulled, pressed))

    def tables(self) -> list[Table | str]:
        """For people: those of its segments."""
        return [part for k, one in enumerate(self.segments) for part in one.tables(f"segment {k + 1}")]

    def _repr_html_(self) -> str:
        return as_html(self.tables())

    def save(self, path: str | Path) -> None:
        """Write all maps into one file: it is whole or absent."""
        checked_file.save(Path(path), KIND, FORMAT, self._write)

    def _write(self, file: h5py.File) -> None:
        for k, one in enumerate(self.segments):
            one.write(file.create_group(str(k)))

    @classmethod
    def load(cls, path: str | Path) -> Chain:
        """Read a chain, or a map as a chain of one.

        Raises:
            ModelError: no file, neither of these, a damaged one, or one of another format.
        """
        if checked_file.kind_of(Path(path)) != KIND:
            return cls([SegmentMap.load(path)])
        return checked_file.load(Path(path), KIND, FORMAT, cls._read)

    @classmethod
    def _read(cls, file: h5py.File) -> Chain:
        return cls([SegmentMap.read(file[str(k)]) for k in range(len(file))])
