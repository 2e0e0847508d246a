"""The displacement of all nodes: its principal components in free space and of what contact adds, and their amounts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rom.contact import Contact
from rom.enrichment import EnrichmentOptions
from rom.free import Free
from rom.parts import Field
from rom.polynomials import Fitted, Samples, fit
from rom.separation import separated
from rom.snapshots import SnapshotSet

FINER = 0.3  # share of the tolerance
MOST = 60  # principal components of one kind of states


def train(
    snapshots: SnapshotSet, free: Free, contact: Contact | None, options: EnrichmentOptions
) -> tuple[Field, tuple[np.ndarray, np.ndarray]]:
    """Fit and separate the displacements of a set; also what they err with states left out, of free and contact states.

    They are asked for seldom, and are separated to a third of the tolerance. Components leave out a tenth of it; those
    in free space less, as what contact adds is found from them.
    """
    options = replace(options, tolerance=FINER * options.tolerance)
    displacement = _flat(snapshots.states_of("free", "displacement"))
    size = float(np.linalg.norm(displacement, axis=1).max())
    basis = _principal(displacement, 0.01 * options.tolerance * size)
    count = free.points.shape[1]
    box = free.polynomial
    amounts = fit(
        Samples(
            points=free.points,
            values=displacement @ basis,
            slopes=snapshots.projected("free", basis)[..., :count],
            weights=np.ones(len(free.points)),
            lower=box.lower,
            upper=box.upper,
        ),
        alike=True,
    )
    form = separated("free displacement", amounts.polynomial, free.points, options, alike=True)
    found = Field(free_basis=basis.astype(np.float32), free=form)
    left_out = np.linalg.norm(amounts.residuals, axis=1) / np.sqrt(len(snapshots.nodes))
    if contact is None:
        return found, (left_out, np.zeros(0))
    found, added = _with_contact(found, snapshots, amounts, basis, contact, options, size)
    return found, (left_out, added)


def _with_contact(
    field: Field,
    snapshots: SnapshotSet,
    free: Fitted,
    free_basis: np.ndarray,
    contact: Contact,
    options: EnrichmentOptions,
    size: float,
) -> tuple[Field, np.ndarray]:
    added = _flat(snapshots.states_of("contact", "displacement"))[contact.touching]
    amounts, turning = free.polynomial.value_and_gradient(contact.parameters[:, :-1])
    added -= amounts @ free_basis.T
    basis = _principal(added, 0.1 * options.tolerance * size)
    values, slopes = added @ basis, snapshots.projected("contact", basis)[contact.touching]
    slopes[..., :-1] -= (basis.T @ free_basis) @ turning
    forms, left_out = [], np.zeros(len(values))
    for part in contact.parts:
        fitted = part.place.fit(values[part.rows], slopes[part.rows], field=True)
        residuals = fitted.residuals * part.place.past[:, None]
        left_out[part.rows] = np.linalg.norm(residuals, axis=1) / np.sqrt(len(snapshots.nodes))
        name = f"displacement in regime {part.code}"
        forms.append(separated(name, fitted.polynomial, part.points, options, alike=True))
    return replace(field, contact_basis=basis.astype(np.float32), regimes=forms), left_out


def _flat(displacement: np.ndarray) -> np.ndarray:
    return displacement.reshape(len(displacement), -1)


def _principal(states: np.ndarray, least: float) -> np.ndarray:
    """Orthonormal basis of states, shape (3 nodes, k); what it leaves out of a state is about `least` at most."""
    values, vectors = np.linalg.eigh(states @ states.T)
    sizes = np.sqrt(np.maximum(values[::-1], 0.0))
    left = np.sqrt(
        np.cumsum(sizes[::-1] ** 2)[::-1] / len(states)
    )  # root mean square over states, of each and all after
    kept = int(np.clip(np.count_nonzero(left > least), 1, MOST))
    basis = states.T @ (vectors[:, ::-1][:, :kept] / np.maximum(sizes[:kept], np.finfo(float).tiny))
    return np.linalg.qr(basis)[0]
