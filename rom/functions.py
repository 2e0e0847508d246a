"""Which one-dimensional functions a model has: Hermite functions, or the kind that held-out states prefer."""

from __future__ import annotations

import logging
from dataclasses import replace

from rom.held_out import check
from rom.separation.hermite import KINDS
from rom.snapshots.snapshot_set import SnapshotError, SnapshotSet
from rom.surrogate import Surrogate
from rom.terminal import Progress, quiet

logger = logging.getLogger(__name__)


def of_kind(model: Surrogate, kind: str) -> Surrogate:
    """The same terms through other functions, see rom.separation.hermite."""
    moved = model.displacements
    if moved is not None:
        moved = replace(moved, free=moved.free.of_kind(kind), regimes=[form.of_kind(kind) for form in moved.regimes])
    return replace(
        model,
        free=model.free.of_kind(kind),
        regimes=[replace(regime, form=regime.form.of_kind(kind)) for regime in model.regimes],
        displacements=moved,
        accuracy={},
    )


def chosen(model: Surrogate, held_out: SnapshotSet, progress: Progress = quiet) -> Surrogate:
    """The model with the kind of functions that errs least at 95 % of states: contact force, or tip without a plane."""
    if not len(held_out.random("parameters")):
        raise SnapshotError(f"{held_out.path}: must have held-out states with an answer, got none")
    found = {}
    for k, kind in enumerate(KINDS):
        progress("choosing one-dimensional functions", k, len(KINDS))
        report = check(replace(of_kind(model, kind), displacements=None), held_out)
        judged = report.get("contact_force", {}).get("p95"), report["tip"]["p95"]
        found[kind] = judged[0] if judged[0] is not None else judged[1]
    progress("choosing one-dimensional functions", len(KINDS), len(KINDS))
    best = min(found, key=lambda kind: found[kind])
    said = ", ".join(f"{kind} {100 * error:.2g} %" for kind, error in found.items())
    logger.info("one-dimensional functions: %s, by the error at the 95th percentile of held-out states: %s", best, said)
    return of_kind(model, best)
