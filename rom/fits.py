"""What is fitted to a set's states, and its separated forms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import count
from typing import Any, NamedTuple

import numpy as np

from rom.components import HEIGHTS, Field, Regime
from rom.fit.chebyshev import Polynomial
from rom.fit.contact_response import ContactResponse
from rom.fit.displacement import FINER, FittedDisplacement
from rom.fit.free_response import FreeResponse
from rom.fit.layout import OUTPUTS, RegimeLayout
from rom.fit.regime_fit import FittedRegime
from rom.separated.alternating_directions import EnrichmentOptions
from rom.separated.separate import separated
from rom.snapshots.contact_regimes import describe
from rom.terminal import Progress

CONDITIONS = 0.1  # how much they count in a regime's separation, beside tip and force


class Fits(NamedTuple):
    """What is fitted to a set's states."""

    free: FreeResponse
    contact: ContactResponse | None
    moved: FittedDisplacement | None


def separated_fits(fits: Fits, options: EnrichmentOptions, progress: Progress) -> dict[str, Any]:
    """The separated forms of all that is fitted, as fields of a surrogate."""
    free, contact, moved = fits
    kinds, parts = 1 if moved is None else 2, [] if contact is None else contact.parts
    total, done = kinds * (1 + len(parts)), count()

    def one_more() -> None:
        progress("separating the snapshots", next(done), total)

    one_more()
    # What contact adds begins where the heights say, so these are to be known better.
    finer = replace(options, tolerance=HEIGHTS * options.tolerance)
    form = separated("tip and touch distance, no contact", free.polynomial, free.known, finer)
    one_more()
    regimes = []
    for part in parts:
        regimes.append(_regime(part, options))
        one_more()
    field = None if moved is None else _field(fits, options, one_more)
    return {"free": form, "regimes": regimes, "displacements": field}


def _regime(part: FittedRegime, options: EnrichmentOptions) -> Regime:
    outputs, name = part.outputs.polynomial, f"tip and contact force, {describe(part.code)}"
    columns = np.eye(outputs.coefficients.shape[1])
    layout = RegimeLayout(len(part.signs), len(columns) > RegimeLayout(0, False).count)
    both = [outputs.mixed(columns[:, OUTPUTS]), *([part.conditions.polynomial] if part.conditions else [])]
    if layout.has_pad:
        both.append(outputs.mixed(columns[:, OUTPUTS.stop :]))
    # Where a condition is near its end, the regimes on both sides say nearly the same: it may err more than they.
    weights = np.ones(layout.count)
    weights[layout.condition_columns] = CONDITIONS
    values = part.conditions.polynomial.value(part.points) if part.conditions else np.zeros((1, 0))
    return Regime(
        code=part.code,
        corner=part.corner,
        begins=part.domain.begins,
        states=len(part.points),
        sizes=np.maximum(np.abs(values).max(axis=0), np.finfo(float).tiny).tolist(),
        form=separated(name, Polynomial.together(both), part.points, options, weights=weights),
    )


def _field(fits: Fits, options: EnrichmentOptions, one_more: Callable[[], None]) -> Field:
    """The displacement field; it is asked for seldom, and separated to a third of the tolerance."""
    free, contact, moved = fits
    assert moved is not None
    options = replace(options, tolerance=FINER * options.tolerance)
    form = separated("displacement field, no contact", moved.free.polynomial, free.known, options, alike=True)
    one_more()
    found = Field(free_basis=moved.free_basis.astype(np.float32), free=form)
    if contact is None:
        return found
    regimes = []
    for part in contact.parts:
        name, polynomial = f"displacement field, {describe(part.code)}", moved.contact[part.code].polynomial
        regimes.append(separated(name, polynomial, part.points, options, alike=True))
        one_more()
    return replace(found, contact_basis=moved.contact_basis.astype(np.float32), regimes=regimes)
