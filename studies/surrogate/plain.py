"""The same states without contact regimes: one separated form for the contact force of all contact states."""

from __future__ import annotations

import numpy as np

from rom.fit import chebyshev
from rom.fit.contact_response import ContactResponse, count_regimes
from rom.fit.free_response import FreeResponse
from rom.held_out import FELT, split
from rom.separated.separate import separated
from rom.separated.separated_form import Separated
from rom.snapshots.snapshot_set import SnapshotSet
from rom.snapshots.training_states import read_training_states
from studies.measures import quantiles
from studies.runner import Run
from studies.surrogate.accuracy import OPTIONS, draft_sets


def without_regimes(training: SnapshotSet, tested: SnapshotSet) -> list[dict]:
    """The same states without regimes: one form over (F, d), and one over (F, s) for all contact states together."""
    table = read_training_states(training)
    free = FreeResponse.of(table)
    contact = ContactResponse.of(table, free, count_regimes([table]))
    lower, upper = table.lower, table.upper
    points, force = tested.random("parameters"), tested.random("contact_force")
    felt = force > FELT
    rows = []

    def fitted(places, states, slopes, ends):
        samples = chebyshev.Samples(
            points=places,
            values=states[:, None],
            slopes=slopes[:, None],
            weights=0.02 / (states / states.max() + 0.02),
            lower=ends[0],
            upper=ends[1],
        )
        return separated("force", chebyshev.fit(samples).polynomial, places, OPTIONS)

    def error(name: str, form: Separated, at: np.ndarray) -> None:
        said = np.maximum([form.value(place)[0] for place in at], 0.0)
        off = np.abs(said - force)[felt] / force[felt]
        rows.append({"form": name, "terms": form.terms} | quantiles(off))

    slopes = table.contact["contact_force_jacobian"][contact.kept]
    # Before touch nothing depends on d: free states stand for planes anywhere beyond their reach.
    tensions, reach = free.points, table.free["touch_distance"]
    away = [np.linspace(max(one, lower[-1]), upper[-1], 6)[1:] for one in reach]
    beyond = np.column_stack([np.repeat(tensions, 5, axis=0), np.concatenate(away)])
    places = np.concatenate([contact.parameters, beyond])
    states = np.concatenate([contact.force, np.zeros(len(beyond))])
    turned = np.concatenate([slopes, np.zeros((len(beyond), slopes.shape[1]))])
    error("one form over (F, d)", fitted(places, states, turned, (lower, upper)), points)

    known, rising = free.polynomial.value_and_gradient(contact.parameters[:, :-1])
    leads = known[:, 3:].argmax(axis=1)
    height = known[np.arange(len(known)), 3 + leads]
    aligned = contact.coordinates.of(contact.parameters, height)
    rises = rising[np.arange(len(known)), 3 + leads]
    by = contact.coordinates.slopes(contact.parameters, height, rises, slopes[:, None])[:, 0]
    ends = np.append(lower[:-1], 0.0), np.append(upper[:-1], aligned[:, -1].max())
    now = free.polynomial.value(points[:, :-1])[:, 3:].max(axis=1)
    at = contact.coordinates.of(points, now)
    form = fitted(aligned, contact.force, by, ends)
    touches = now > points[:, -1]
    error("one form over (F, s)", form, np.where(touches[:, None], at, np.append(lower[:-1], 0.0)))
    return rows


def measure(run: Run) -> list[dict]:
    """Errors of the contact force on the test states of the draft finger."""
    training, held_out = draft_sets(run)
    return without_regimes(training, split(held_out)[1])
