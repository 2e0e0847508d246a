"""The map of a segment and its file: tensions and the wrench on the plate -> the plate's pose, and how it changes."""

from __future__ import annotations

import json
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np
from numpy.typing import ArrayLike

from rom import checked_file
from rom.brief import brief
from rom.checked_file import ModelError
from rom.fit.chebyshev import Polynomial
from rom.native import PickledByFields
from rom.rod import limits, native
from rom.segment.field import Field
from rom.snapshots.rigid_motion import motions, rotations
from rom.table import NOT_MEASURED, Table, accuracy, as_html, parameters, percent

KIND, FORMAT = "fingerfem segment map", 2
PLAIN = ("parameters", "scene", "accuracy", "provenance", "finer_mesh_factors")


@brief
class Placed(NamedTuple):
    """Where a plate is, at n inputs; shapes without n at one.

    Attributes:
        centre: of the plate, shape (n, 3) [m].
        rotation: of its frame, shape (n, 3, 3) [-].
        motion: R^T dc and R^T dtheta by the inputs, shape (n, 6, t + 6) [m, rad per N, N m].
        inside: whether the inputs lie in the trained box, shape (n,).
    """

    centre: np.ndarray
    rotation: np.ndarray
    motion: np.ndarray
    inside: np.ndarray


@brief
@dataclass(frozen=True, kw_only=True)
class SegmentMap(PickledByFields):
    """A segment condensed to its plate.

    Attributes:
        parameters: name, unit, lower and upper of every input: tensions, then force and moment in the plate's frame.
        pose: the clamp's place seen from the plate [m], then the plate's quaternion [-], by the inputs.
        corners: how far tensions bend the plate's corners from those of a box, in its own frame, 8 x 3 values of the
            inputs [m], the first axis' sign alternating fastest; None if the set did not store the displacement.
        skin: points of the rubber's long edges in the plate's frame by the inputs, 3 values each [m]; None if the set
            did not store the displacement: then nobody notices rubber that touches.
        skin_error: of these, 95th percentile [m].
        displacements: where nodes are, seen from the plate; None if the set did not store them.
        shortenings: of the tendons, likewise [m].
        shortening_error: of these, 95th percentile [m].
        force_error: relative error of contact forces, 95th percentile of states predicted without their lines [-].
        place_error: of the free plate, likewise [m].
        place_error_by_force: what a force on the plate adds to that, a newton, likewise [m/N].
        finer_mesh_factors: by quantity, times how much its estimated error covers what states on a finer mesh showed;
            empty if nobody looked.
        accuracy: measured on held-out states; empty if nobody did.
        scene: the trained scene as plain data.
        provenance: what it was made from.

    Example:
        >>> segment = SegmentMap.load("finger.h5")
        >>> segment.place([50.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0]).centre
    """

    parameters: list[dict[str, Any]]
    pose: Polynomial
    force_error: float
    place_error: float
    place_error_by_force: float
    scene: dict[str, Any]
    provenance: dict[str, Any]
    corners: Polynomial | None = None
    skin: Polynomial | None = None
    skin_error: float = np.nan
    displacements: Field | None = None
    shortenings: Polynomial | None = None
    shortening_error: float = np.nan
    finer_mesh_factors: dict[str, float] = field(default_factory=dict)
    accuracy: dict[str, Any] = field(default_factory=dict)

    @property
    def names(self) -> list[str]:
        """Of the inputs."""
        return [parameter["name"] for parameter in self.parameters]

    @property
    def tensions(self) -> int:
        """Number of tensions."""
        return len(self.parameters) - 6

    @property
    def tension_parameters(self) -> list[dict[str, Any]]:
        """Name, unit, lower and upper of the tensions."""
        return self.parameters[: self.tensions]

    @property
    def expected_error(self) -> float:
        """Relative error of contact forces, 95th percentile, the mesh's included if it was estimated [-]."""
        return self.force_error * self.finer_mesh_factors.get("contact_force", 1.0)

    @property
    def half_lengths(self) -> np.ndarray:
        """Of the plate along its own axes, shape (3,) [m]."""
        geometry = self.scene["geometry"]
        return np.array([geometry["plate"], geometry["side"], geometry["side"]]) / 2

    @property
    def rest(self) -> np.ndarray:
        """The plate's centre in the undeformed finger, shape (3,) [m]."""
        geometry = self.scene["geometry"]
        return np.array([sum(geometry["segments"]) - geometry["plate"] / 2, 0.0, 0.0])

    @cached_property
    def struct(self) -> Any:
        """For compiled code, a struct fingerfem_segment.

        Raises:
            ModelError: a map beyond what compiled code holds.
        """
        limits.check_sizes(self)
        return native.struct(
            native.Segment(
                elements=[self.pose],
                half_lengths=self.half_lengths,
                corners=self.corners,
                skin=self.skin,
                skin_error=self.skin_error,
            )
        )

    def place(self, inputs: ArrayLike) -> Placed:
        """Where the plate is at inputs, shape (t + 6,) or (n, t + 6) [N, N m].

        Beyond the trained box the map goes on linearly, and says so.

        Raises:
            ModelError: the wrong number of inputs.
        """
        points = self._points(inputs)
        poses, jacobians = self.pose.value_and_gradient(points)
        turned, most = rotations(poses), self.pose.upper[self.tensions]  # [N], of a force in any direction
        found = Placed(
            centre=-np.einsum("nij,nj->ni", turned, poses[:, :3]),
            rotation=turned,
            motion=motions(poses, jacobians),
            inside=np.all((points >= self.pose.lower) & (points <= self.pose.upper), axis=1)
            & (np.linalg.norm(points[:, self.tensions : self.tensions + 3], axis=1) <= most * (1 + 1e-12)),
        )
        return found if np.ndim(inputs) > 1 else Placed(*(part[0] for part in found))

    def displacement(self, inputs: ArrayLike) -> np.ndarray:
        """Of the nodes at inputs, shape (t + 6,) or (n, t + 6) [N, N m]; shape (nodes, 3) or (n, nodes, 3) [m].

        Raises:
            ModelError: the wrong number of inputs, or a set that did not store displacements.
        """
        if self.displacements is None:
            raise _not_stored("displacement")
        points = self._points(inputs)
        placed = self.place(points)
        turned = np.einsum("nij,nmj->nmi", placed.rotation, self.displacements.places(points))
        found = placed.centre[:, None] + turned - self.displacements.nodes
        return found if np.ndim(inputs) > 1 else np.asarray(found[0])

    def shortening(self, inputs: ArrayLike) -> np.ndarray:
        """How much shorter the tendons have become at inputs, shape (t + 6,) or (n, t + 6); shape (t,) or (n, t) [m].

        Raises:
            ModelError: the wrong number of inputs, or a set that did not store them.
        """
        if self.shortenings is None:
            raise _not_stored("channel_shortening")
        found = self.shortenings.value(self._points(inputs))
        return found if np.ndim(inputs) > 1 else np.asarray(found[0])

    def _points(self, inputs: ArrayLike) -> np.ndarray:
        """Inputs as rows."""
        points = np.atleast_2d(np.asarray(inputs, float))
        if points.shape[-1] != len(self.parameters):
            raise ModelError(f"inputs must be {', '.join(self.names)} (in that order), got shape {np.shape(inputs)}")
        return points

    def with_accuracy(self, accuracy: dict[str, Any]) -> SegmentMap:
        """The same, whose error has been measured."""
        return replace(self, accuracy=accuracy)

    def without_displacements(self) -> SegmentMap:
        """The same map without the field of its nodes, which is most of a file."""
        return replace(self, displacements=None)

    def tables(self, name: str = "segment") -> list[Table | str]:
        """For people: what it is made of, its inputs, and what it was measured to err by."""
        states = f" from {self.provenance['states']} states" if "states" in self.provenance else ""
        error = self.expected_error
        parts: list[Table | str] = [f"{self.scene['name']}, {name}: {len(self.pose.powers):,} products{states}"]
        parts += [parameters(self.parameters), f"contact force within {percent(error)}, as it expects of itself (95 %)"]
        measured = accuracy(self.accuracy)
        return [*parts, *measured] if measured else [*parts, NOT_MEASURED]

    def _repr_html_(self) -> str:
        return as_html(self.tables())

    def save(self, path: str | Path) -> None:
        """Write the map: the file is whole or absent."""
        checked_file.save(Path(path), KIND, FORMAT, self.write)

    def write(self, file: h5py.Group) -> None:
        """Write the map into an open file."""
        for name in PLAIN:
            file.attrs[name] = json.dumps(getattr(self, name))
        file.attrs["force_error"], file.attrs["place_error"] = self.force_error, self.place_error
        file.attrs["place_error_by_force"], file.attrs["skin_error"] = self.place_error_by_force, self.skin_error
        if self.corners is not None:
            checked_file.dataset(file, "corner_powers", self.corners.powers, "-")
            checked_file.dataset(file, "corner_coefficients", self.corners.coefficients, "m")
        if self.skin is not None:
            checked_file.dataset(file, "skin_powers", self.skin.powers, "-")
            checked_file.dataset(file, "skin_coefficients", self.skin.coefficients.astype(np.float32), "m")
        if self.shortenings is not None:
            file.attrs["shortening_error"] = self.shortening_error
            checked_file.dataset(file, "shortening_powers", self.shortenings.powers, "-")
            checked_file.dataset(file, "shortening_coefficients", self.shortenings.coefficients, "m")
        if self.displacements is not None:
            file.attrs["field_error"] = self.displacements.error
            checked_file.dataset(file, "nodes", self.displacements.nodes, "m")
            checked_file.dataset(file, "field_mean", self.displacements.mean.astype(np.float32), "m")
            checked_file.dataset(file, "field_modes", self.displacements.modes.astype(np.float32), "-")
            checked_file.dataset(file, "field_powers", self.displacements.amounts.powers, "-")
            checked_file.dataset(
                file, "field_coefficients", self.displacements.amounts.coefficients.astype(np.float32), "m"
            )
        checked_file.dataset(file, "box", np.array([self.pose.lower, self.pose.upper]), "N, N m")
        checked_file.dataset(file, "powers", self.pose.powers, "-")
        checked_file.dataset(file, "coefficients", self.pose.coefficients, "m, m, m, -, -, -, -")

    @classmethod
    def load(cls, path: str | Path) -> SegmentMap:
        """Read a map.

        Raises:
            ModelError: no file, no map, a damaged one, or one of another format.
        """
        return checked_file.load(Path(path), KIND, FORMAT, cls.read)

    @classmethod
    def read(cls, file: h5py.Group) -> SegmentMap:
        """The map in an open file."""
        lower, upper = file["box"][:].astype(float)

        def polynomial(prefix: str) -> Polynomial:
            powers, coefficients = (file[f"{prefix}{name}"][:] for name in ("powers", "coefficients"))
            return Polynomial(
                lower=lower, upper=upper, powers=powers.astype(int), coefficients=coefficients.astype(float)
            )

        found = cls(
            **{name: json.loads(file.attrs[name]) for name in PLAIN},
            force_error=float(file.attrs["force_error"]),
            place_error=float(file.attrs["place_error"]),
            place_error_by_force=float(file.attrs["place_error_by_force"]),
            skin_error=float(file.attrs["skin_error"]),
            pose=polynomial(""),
            corners=polynomial("corner_") if "corner_powers" in file else None,
            skin=polynomial("skin_") if "skin_powers" in file else None,
            displacements=_field(file, polynomial("field_")) if "field_powers" in file else None,
            shortenings=polynomial("shortening_") if "shortening_powers" in file else None,
            shortening_error=float(file.attrs.get("shortening_error", np.nan)),
        )
        limits.check(found)
        return found


def _not_stored(quantity: str) -> ModelError:
    return ModelError(f"sampling.store must have named {quantity} when the states were solved, got a set without")


def _field(file: h5py.Group, amounts: Polynomial) -> Field:
    modes = file["field_modes"][:].astype(float)
    mean = file["field_mean"][:].astype(float)
    return Field(
        nodes=file["nodes"][:], mean=mean, modes=modes, amounts=amounts, error=float(file.attrs["field_error"])
    )
