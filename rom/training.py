"""A snapshot set -> a surrogate: the free states by tensions, the contact states regime by regime.

In free space everything is a smooth function of the tensions; in contact, it is one in every regime (rom.regimes), of
contact-aligned coordinates (rom.chart). Each is fitted by a polynomial to the values and sensitivities of its states,
wherever they lie (rom.polynomials), and then separated (rom.separation).
"""

from __future__ import annotations

import logging
from dataclasses import replace

import numpy as np

from rom import chart, error_map, fields
from rom.contact import Contact
from rom.enrichment import EnrichmentOptions
from rom.free import Free
from rom.parts import Errors
from rom.separation import separated
from rom.snapshots import SnapshotError, SnapshotSet
from rom.surrogate import HEIGHTS, Surrogate

logger = logging.getLogger(__name__)


def train(snapshots: SnapshotSet, options: EnrichmentOptions) -> Surrogate:
    """Build the surrogate of a training set; states may have failed, and lines that refine it be missing.

    Raises:
        SnapshotError: a held-out set, or no state with an answer, or none that touches the plane.
    """
    description = snapshots.description
    if description.random:
        raise SnapshotError(f"{snapshots.path}: must be a training set, got a held-out set (made with --random)")
    for kind in ("free", "contact") if description.has_obstacle else ("free",):
        if not snapshots.count(kind):
            raise SnapshotError(f"{snapshots.path}: must have {kind} states with an answer, got none")
    for task, parameters, reason in snapshots.failures:
        logger.warning("done without the failed state of %s at %s: %s", task, parameters.tolist(), reason)
    if snapshots.missing:
        logger.warning("done without %d lines that are not solved yet", len(snapshots.missing))
    free = Free.of(snapshots)
    contact = Contact.of(snapshots, free) if description.has_obstacle else None
    if contact is not None:
        free, contact = contact.with_its_corners(free)
    places, near = contact.map() if contact else (np.zeros(1, np.int64), np.zeros(1, np.uint64))
    field, left_out = None, (np.zeros(0), np.zeros(0))
    if description.has_field:
        field, left_out = fields.train(snapshots, free, contact, options)
    unknown = Errors(
        tip=np.nan, displacement=np.nan, touch_distance=np.nan, contact=np.full((len(places), 3), np.nan), margin=0.0
    )
    model = Surrogate(
        parameters=description.parameters,
        # What contact adds begins where the heights say, so these are to be known better.
        free=separated("free", free.polynomial, free.points, replace(options, tolerance=HEIGHTS * options.tolerance)),
        regimes=[] if contact is None else [part.separated(options) for part in contact.parts],
        map=places,
        near=near,
        way=chart.Way(0.0, 1.0) if contact is None else contact.way,
        errors=unknown,
        displacements=field,
        lead=description.lead,
        nodes=snapshots.nodes,
        scene=description.scene,
        accuracy={},
        provenance={
            "fingerprint": description.fingerprint,
            "versions": description.versions,
            "states": snapshots.states,
            "failed": len(snapshots.failures),
            "tolerance": options.tolerance,
        },
    )
    return replace(model, errors=error_map.estimate(model, snapshots, free, contact, left_out))
