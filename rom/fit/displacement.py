"""The displacement of all nodes: its POD modes in free space and of what contact adds, and their amounts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from rom.brief import brief
from rom.fit.chebyshev import Fitted, Samples, fit
from rom.fit.contact_response import ContactResponse
from rom.fit.free_response import FreeResponse
from rom.snapshots.contact_regimes import Code
from rom.snapshots.training_states import TrainingStates

FINER = 0.3  # share of the tolerance
MOST_MODES = 60  # POD modes of one kind of states


@brief
@dataclass(frozen=True, kw_only=True)
class FittedDisplacement:
    """The fitted displacements of a set.

    Attributes:
        free_basis: POD modes in free space, shape (3 nodes, k).
        free: their amounts by tensions [m].
        contact_basis: POD modes of what contact adds.
        contact: their amounts in every regime, see rom.fit.regime_fit.
        left_out: what they err with states left out, root mean square over the nodes, of free and contact states [m].
    """

    free_basis: np.ndarray
    free: Fitted
    contact_basis: np.ndarray
    contact: dict[Code, Fitted]
    left_out: tuple[np.ndarray, np.ndarray]

    def on(self, bring: Callable[[np.ndarray], np.ndarray]) -> FittedDisplacement:
        """The same on the nodes of another mesh, to which `bring` interpolates columns of 3 nodes."""
        return replace(self, free_basis=bring(self.free_basis), contact_basis=bring(self.contact_basis))


def fitted(
    states: TrainingStates,
    free: FreeResponse,
    contact: ContactResponse | None,
    tolerance: float,
    before: FittedDisplacement | None = None,
) -> FittedDisplacement:
    """Fit the displacements of a set, or correct by them what is known before, from a coarser mesh.

    Components leave out a tenth of what their amounts are separated to; those in free space less, as what contact adds
    is found from them.
    """
    displacement = _flat(states.free["displacement"])
    size = float(np.linalg.norm(displacement, axis=1).max())
    least, count = FINER * tolerance * size, free.points.shape[1]
    if before is None:
        basis = _pod(displacement, 0.01 * least)
    else:
        known = before.free.polynomial.value(free.points) @ before.free_basis.T
        basis = _beside(before.free_basis, displacement - known, 0.01 * least)
    samples = Samples(
        points=free.points,
        values=displacement @ basis,
        slopes=states.field_slopes("free", basis)[..., :count],
        weights=np.ones(len(free.points)),
        lower=free.polynomial.lower,
        upper=free.polynomial.upper,
        noise=free.noise,
    )
    prior = None if before is None else before.free.polynomial.mixed(before.free_basis.T @ basis)
    amounts = fit(samples, prior, alike=True)
    found = FittedDisplacement(
        free_basis=basis,
        free=amounts,
        contact_basis=np.zeros((len(basis), 0)),
        contact={},
        left_out=(np.linalg.norm(amounts.residuals, axis=1) / np.sqrt(len(states.body.nodes)), np.zeros(0)),
    )
    return found if contact is None else _with_contact(found, states, contact, 0.1 * least, before)


def _with_contact(
    found: FittedDisplacement,
    states: TrainingStates,
    contact: ContactResponse,
    least: float,
    before: FittedDisplacement | None,
) -> FittedDisplacement:
    added = _flat(states.contact["displacement"])[contact.kept]
    amounts, amount_jacobian = found.free.polynomial.value_and_gradient(contact.parameters[:, :-1])
    added -= amounts @ found.free_basis.T
    if before is None:
        basis = _pod(added, least)
    else:
        beyond = added.copy()
        for part in contact.parts:
            if part.domain.before is not None:
                known = before.contact[part.code].polynomial.value(part.domain.blank.points) * part.domain.past[:, None]
                beyond[part.rows] -= known @ before.contact_basis.T
        basis = _beside(before.contact_basis, beyond, least)
    values, slopes = added @ basis, states.field_slopes("contact", basis)[contact.kept]
    slopes[..., :-1] -= (basis.T @ found.free_basis) @ amount_jacobian
    fits, left_out = {}, np.zeros(len(values))
    for part in contact.parts:
        prior = None
        if before is not None and part.domain.before is not None:
            prior = before.contact[part.code].polynomial.mixed(before.contact_basis.T @ basis)
        fits[part.code] = one = part.domain.fit(values[part.rows], slopes[part.rows], prior, field=True)
        residuals = one.residuals * part.domain.past[:, None]
        left_out[part.rows] = np.linalg.norm(residuals, axis=1) / np.sqrt(len(states.body.nodes))
    return replace(found, contact_basis=basis, contact=fits, left_out=(found.left_out[0], left_out))


def _flat(displacement: np.ndarray) -> np.ndarray:
    return displacement.reshape(len(displacement), -1)


def _beside(known: np.ndarray, beyond: np.ndarray, least: float) -> np.ndarray:
    """Orthonormal basis of what is known and of the states beyond it, shape (3 nodes, k)."""
    return np.linalg.qr(np.column_stack([known, _pod(beyond, least)]))[0]


def _pod(states: np.ndarray, least: float) -> np.ndarray:
    """Orthonormal basis of states, shape (3 nodes, k); what it leaves out of a state is about `least` at most."""
    values, vectors = np.linalg.eigh(states @ states.T)
    sizes = np.sqrt(np.maximum(values[::-1], 0.0))
    left = np.sqrt(
        np.cumsum(sizes[::-1] ** 2)[::-1] / len(states)
    )  # root mean square over states, of each and all after
    kept = int(np.clip(np.count_nonzero(left > least), 1, MOST_MODES))
    basis = states.T @ (vectors[:, ::-1][:, :kept] / np.maximum(sizes[:kept], np.finfo(float).tiny))
    return np.linalg.qr(basis)[0]
