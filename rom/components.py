"""What a surrogate is made of besides its free answer, and what it answers: regimes, field, errors, answers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from rom.brief import brief
from rom.fit.contact_coordinates import ContactCoordinates
from rom.fit.layout import RegimeLayout
from rom.fit.mesh_error import MeshError
from rom.separated.separated_form import Separated
from rom.snapshots.contact_regimes import Code

HEIGHTS = 0.01  # share of a tolerance that free tip and heights are kept to


@brief
@dataclass(frozen=True, kw_only=True)
class Regime:
    """Contact in one regime, see rom.snapshots.contact_regimes.

    Attributes:
        code: its active contacts.
        corner: which of the free form's heights is that of the corner whose contact path is its coordinate.
        begins: whether it begins at touch: tip and force are then per length of that path.
        states: number of states it was fitted to.
        sizes: what its conditions are large or small against.
        form: what contact adds to the tip [m], contact force [N], conditions, pad pressure [Pa] if it is known; by
            tensions and s.
    """

    code: Code
    corner: int
    begins: bool
    states: int
    sizes: Sequence[float]
    form: Separated

    @property
    def layout(self) -> RegimeLayout:
        """Which column of the form is which."""
        conditions = len(self.sizes)
        return RegimeLayout(conditions, len(self.form.modes) > RegimeLayout(conditions, False).count)


@brief
@dataclass(frozen=True, kw_only=True)
class Field:
    """The displacement of all nodes.

    Attributes:
        free_basis: POD modes in free space, shape (3 nodes, k), single precision.
        free: their amounts by tensions [m].
        contact_basis: POD modes of what contact adds; None without an obstacle.
        regimes: their amounts in every regime, as in Regime.form.
    """

    free_basis: np.ndarray
    free: Separated
    contact_basis: np.ndarray | None = None
    regimes: Sequence[Separated] = ()


@brief
@dataclass(frozen=True, kw_only=True)
class Errors:
    """The surrogate's estimate of its own error, see rom.error_model; meant to cover 95 % of the true ones.

    Attributes:
        tip: in free space [m].
        displacement: in free space, root mean square over the nodes [m]; 0 without the field.
        touch_distance: [m].
        contact: of tip, contact force, displacement and pad pressure, if that is known, per length of contact path
            [-, N/m, -, Pa/m], by cell of the regime lookup, shape (cells, 3 or 4).
        margin: added to the contact path [m].
        mesh: what the mesh adds, as a finer one told; None where that is not known.
    """

    tip: float
    displacement: float
    touch_distance: float
    contact: np.ndarray
    margin: float
    mesh: MeshError | None = None


@brief
@dataclass(frozen=True, kw_only=True)
class Components:
    """All that a model file holds, see rom.model_file.

    Attributes:
        parameters: name, unit, lower and upper of each parameter, tensions first, then d.
        free: tip [m], then heights [m] of what may touch first, by the tensions.
        regimes: contact in every regime; none without an obstacle.
        regime_lookup: regime to begin with by cell of the box, flat.
        possible_regimes: bits of the regimes that are possible there.
        coordinates: the contact-aligned ones.
        errors: what it knows of its error.
        displacements: of all nodes; None if the scene does not store it.
        lead: index of the lead tension.
        nodes: the finger's nodes at rest, shape (nodes, 3) [m].
        scene: the scene it was trained on.
        accuracy: error by quantity on held-out states, see rom.held_out.check; `against_finer_mesh` has those of mesh
            and surrogate together, if they were measured; empty if not checked with these terms.
        provenance: versions, states, fingerprint.
    """

    parameters: list[dict[str, Any]]
    free: Separated
    regimes: Sequence[Regime]
    regime_lookup: np.ndarray = field(repr=False)
    possible_regimes: np.ndarray = field(repr=False)
    coordinates: ContactCoordinates
    errors: Errors = field(repr=False)
    displacements: Field | None = field(repr=False)
    lead: int
    nodes: np.ndarray = field(repr=False)
    scene: dict[str, Any] = field(repr=False)
    accuracy: dict[str, dict[str, Any]]
    provenance: dict[str, Any]

    @property
    def names(self) -> list[str]:
        """Names of the parameters in order."""
        return [parameter["name"] for parameter in self.parameters]

    @property
    def has_obstacle(self) -> bool:
        """Whether the last parameter is the plane's distance."""
        return self.names[-1] == "d"

    @property
    def has_field(self) -> bool:
        """Whether it knows the displacement of all nodes."""
        return self.displacements is not None

    @property
    def has_pad(self) -> bool:
        """Whether it knows the pad's pressure."""
        return any(regime.layout.has_pad for regime in self.regimes)

    @property
    def forms(self) -> dict[str, Separated]:
        """Its separated forms by name."""
        found = {"free": self.free} | {f"regime {r}": regime.form for r, regime in enumerate(self.regimes)}
        if self.displacements is not None:
            found["free displacement"] = self.displacements.free
            found |= {f"displacement in regime {r}": form for r, form in enumerate(self.displacements.regimes)}
        return found

    @cached_property
    def limits(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper end of the trained box, shapes (p,)."""
        return (
            np.array([parameter["lower"] for parameter in self.parameters], float),
            np.array([parameter["upper"] for parameter in self.parameters], float),
        )
