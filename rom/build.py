"""A snapshot set -> a surrogate: the free states by tensions, the contact states regime by regime.

In free space everything is a smooth function of the tensions; in contact, it is one in every regime
(snapshots.contact_regimes), of contact-aligned coordinates (fit.contact_coordinates). Each is fitted by a polynomial to
the values and sensitivities of its states, wherever they lie (fit.chebyshev), and then separated (separation). States
on a coarser mesh, if there are any, are fitted first, and what they say is corrected by the others
(snapshots.mesh_transfer).
"""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from rom import error_model
from rom.components import Errors
from rom.elements import training
from rom.elements.samples.section_states import read_section_states
from rom.file_kinds import uses_of
from rom.fit import displacement
from rom.fit.chebyshev import CALM, NOISE
from rom.fit.contact_coordinates import ContactCoordinates
from rom.fit.contact_response import ContactResponse, count_regimes
from rom.fit.free_response import FreeResponse
from rom.fits import Fits, separated_fits
from rom.held_out import check_finer
from rom.rod.rod import Rod
from rom.separated.alternating_directions import EnrichmentOptions
from rom.snapshots import mesh_transfer
from rom.snapshots.contact_regimes import Code
from rom.snapshots.snapshot_set import SnapshotError, SnapshotSet
from rom.snapshots.training_states import TrainingStates, check_count, read_training_states
from rom.surrogate import Surrogate
from rom.terminal import Progress, quiet

logger = logging.getLogger(__name__)


def train(
    snapshots: SnapshotSet,
    options: EnrichmentOptions,
    coarse: SnapshotSet | None = None,
    *,
    progress: Progress = quiet,
) -> Surrogate:
    """Build the surrogate of a training set; states may have failed, and lines that refine it be missing.

    Args:
        snapshots: the set.
        options: of the separation.
        coarse: a set of the same finger on a coarser mesh, which the first then corrects.
        progress: called with the step, how much of it is done, and how much it is.

    Raises:
        SnapshotError: a held-out set, or no state with an answer, or none that touches the plane; or sets
            of two fingers.
    """
    description, sets = snapshots.description, [snapshots] if coarse is None else [snapshots, coarse]
    stored = set.intersection(*(set(one.description.stored) for one in sets))
    states = [read_training_states(one, stored) for one in sets]
    for one in sets:
        _tell_what_is_missing(one)
    if coarse is not None:
        mesh_transfer.check_pair(snapshots, coarse)
    check_count(sets[-1])  # few on a fine mesh correct many
    has_pad = "pad_pressure" in stored
    counts = count_regimes(states) if description.has_obstacle else Counter()
    before = None
    if coarse is not None:
        progress("fitting the coarse states", 0, 1)
        before = _fitted(states[1], counts, options, noise=CALM)
        progress("fitting the coarse states", 1, 1)
        if before.moved is not None:
            before = before._replace(moved=before.moved.on(mesh_transfer.interpolation(coarse.nodes, snapshots.nodes)))
    progress("fitting the states", 0, 1)
    free, contact, moved = _fitted(states[0], counts, options, before)
    progress("fitting the states", 1, 1)
    if contact is not None:
        free, contact = contact.with_its_corners(free)
    lookup, possible = contact.regime_lookup() if contact else (np.zeros(1, np.int64), np.zeros(1, np.uint64))
    unknown = Errors(
        tip=np.nan,
        displacement=np.nan,
        touch_distance=np.nan,
        contact=np.full((len(lookup), 3 + has_pad), np.nan),
        margin=0.0,
    )
    model = Surrogate(
        parameters=description.parameters,
        **separated_fits(Fits(free, contact, moved), options, progress),
        regime_lookup=lookup,
        possible_regimes=possible,
        coordinates=ContactCoordinates(0.0, 1.0) if contact is None else contact.coordinates,
        errors=unknown,
        lead=description.lead,
        nodes=snapshots.nodes if moved is not None else np.zeros((0, 3)),
        scene=description.scene,
        accuracy={},
        provenance={
            "fingerprint": description.fingerprint,
            "versions": description.versions,
            "states": snapshots.states,
            "failed": len(snapshots.failures),
            "tolerance": options.tolerance,
        }
        | ({} if coarse is None else {"coarse": _origin(coarse)}),
    )
    progress("estimating the errors", 0, 1)
    model = replace(model, errors=error_model.estimate(model, states[0], free, contact, moved))
    progress("estimating the errors", 1, 1)
    return model


def train_rod(
    snapshots: SnapshotSet, provenance: dict[str, Any], finer: Sequence[SnapshotSet], progress: Progress = quiet
) -> Rod:
    """Build the finger of a set of pressed states.

    Args:
        snapshots: the set.
        provenance: what it is.
        finer: states on a finer mesh: pressed ones correct its elements, those before the plane enlarge estimates.
        progress: called with the step, how much of it is done, and how much it is.

    Raises:
        SnapshotError: a held-out set, too few lines, or sets of another finger, or on no finer mesh.
        ValueError: two finer sets of pressed states.
    """
    if snapshots.description.random:
        raise SnapshotError(f"{snapshots.path}: must be a training set{uses_of(snapshots.path)}")
    for one in finer:
        check_finer(snapshots.description.scene, one)
    pressed = [one for one in finer if one.description.has_load]
    before_plane = [one for one in finer if not one.description.has_load]
    if len(pressed) > 1:
        raise ValueError(f"finer must be one set of pressed states at most, got {len(pressed)}")
    sections = read_section_states(snapshots)
    corrects = read_section_states(pressed[0], sections.at) if pressed else None
    provenance = provenance | ({"corrected_by": error_model.origin_of(pressed[0])} if pressed else {})
    finger = Rod(elements=training.train(sections, provenance, progress, corrects), scene=sections.scene)
    return error_model.rod_with_mesh_error(finger, before_plane) if before_plane else finger


def _tell_what_is_missing(snapshots: SnapshotSet) -> None:
    description = snapshots.description
    for task, parameters, reason in snapshots.failures:
        named = zip(description.parameters, parameters, strict=True)
        at = " ".join(f"{one['name']}={value:.6g}" for one, value in named if np.isfinite(value))
        logger.warning("done without the failed state of %s at %s: %s", task, at, reason)
    if snapshots.missing:
        logger.warning(
            "done without %d lines of states that are not solved yet; fingerfem snapshots goes on with them",
            len(snapshots.missing),
        )


def _fitted(
    states: TrainingStates,
    counts: Counter[Code],
    options: EnrichmentOptions,
    before: Fits | None = None,
    noise: float = NOISE,
) -> Fits:
    """Fit a set's states, or correct by them what is known before."""
    contact = moved = None
    free = FreeResponse.of(states, before.free if before else None, noise)
    if states.has_obstacle:
        contact = ContactResponse.of(states, free, counts, before.contact if before else None)
    if "displacement" in states.free:
        moved = displacement.fitted(states, free, contact, options.tolerance, before.moved if before else None)
    return Fits(free, contact, moved)


def _origin(coarse: SnapshotSet) -> dict[str, Any]:
    description = coarse.description
    return {
        "fingerprint": description.fingerprint,
        "cells": description.scene["mesh"]["cells"],
        "states": coarse.states,
        "failed": len(coarse.failures),
    }
