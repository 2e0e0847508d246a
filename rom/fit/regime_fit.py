"""One contact regime, fitted: where its states lie in its coordinates, its quantities, and what ends it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rom.brief import brief
from rom.fit import layout
from rom.fit.chebyshev import Fitted, Polynomial, Samples, fit
from rom.fit.contact_coordinates import ContactCoordinates
from rom.fit.free_response import FreeResponse
from rom.snapshots import contact_regimes
from rom.snapshots.contact_regimes import Code

SHORT = 0.1  # share of the longest contact path below which one is short
ROWS = 2.5  # of a correction for every coefficient: states come in few lines, and these are not left out whole
BEYOND = 1.5  # of a box scaled to [-1, 1], how far beyond a fit is still of use
SMALL = 0.02  # share of a regime's largest force below which errors count as of that force


@brief
@dataclass(frozen=True, kw_only=True)
class FitDomain:
    """Where the states of a regime lie in its coordinates.

    Attributes:
        parameters: shape (n, p).
        height: of the regime's corner in free space at their tensions [m], shape (n,).
        height_jacobian: its derivatives by the tensions, shape (n, p - 1).
        begins: whether the regime begins at touch.
        coordinates: the contact-aligned ones.
        blank: the samples without values.
        before: what is known of the regime on a coarser mesh, and is corrected; None if that is nothing of use.
    """

    parameters: np.ndarray
    height: np.ndarray
    height_jacobian: np.ndarray
    begins: bool
    coordinates: ContactCoordinates
    blank: Samples
    before: FittedRegime | None

    @property
    def past(self) -> np.ndarray:
        """By which quantities that grow from touch on are divided: the contact path [m], or 1; shape (n,)."""
        return self.height - self.parameters[:, -1] if self.begins else np.ones(len(self.height))

    def fit(
        self,
        values: np.ndarray,
        slopes: np.ndarray,
        before: Polynomial | None,
        grows: bool = True,
        field: bool = False,
    ) -> Fitted:
        """Fit quantities, shape (n, m), with derivatives by the parameters, shape (n, m, p); or what is known `before`.

        Those that grow from touch on are fitted per length of contact path where the regime begins at touch. For
        those of a field, which count alike, paths so short that they magnify what its basis leaves out count little.
        """
        samples = self.blank
        if self.begins and grows:
            past = self.past
            past_jacobian = np.column_stack([self.height_jacobian, np.full(len(past), -1.0)])
            values = values / past[:, None]
            slopes = (slopes - values[..., None] * past_jacobian[:, None]) / past[:, None, None]
            if field:
                samples = replace(samples, weights=past / (past + SHORT * past.max(initial=0.0)))
        aligned = self.coordinates.slopes(self.parameters, self.height, self.height_jacobian, slopes)
        samples = replace(samples, values=values, slopes=aligned)
        return fit(samples, before, alike=field, rows=None if before is None else ROWS)


@brief
@dataclass(frozen=True, kw_only=True)
class FittedRegime:
    """The contact states of one regime.

    Attributes:
        code: of the regime.
        rows: of its states among all contact states.
        corner: which height of the free states is that of its corner.
        domain: where they lie.
        points: contact-aligned coordinates of the states from which it is known, on all meshes, shape (n, p).
        outputs: tip added, contact force, and pad pressure if that is to be known.
        signs: conditions, and the fit of their values.
    """

    code: Code
    rows: np.ndarray
    corner: int
    domain: FitDomain
    points: np.ndarray
    outputs: Fitted
    signs: list[contact_regimes.Sign]
    conditions: Fitted | None


def _of_use(before: FittedRegime | None, points: np.ndarray) -> FittedRegime | None:
    """What is known before, unless it is from fewer states than these, or of a box that they lie beyond."""
    if before is None or not len(points):
        return before
    box = before.domain.blank
    scaled = np.abs(2 * (points - box.lower) / (box.upper - box.lower) - 1)
    return before if len(before.points) > len(points) and scaled.max() <= BEYOND else None


def fit_domain(
    states: dict[str, np.ndarray],
    free: FreeResponse,
    height: int,
    begins: bool,
    coordinates: ContactCoordinates,
    before: FittedRegime | None,
) -> FitDomain:
    """Where the states of a regime lie, shapes (states, ...), in the box of what is known before, if anything is."""
    parameters, force = states["parameters"], states["contact_force"]
    known, jacobian = free.polynomial.value_and_gradient(parameters[:, :-1])
    points = coordinates.of(parameters, known[:, layout.height(height)])
    before = _of_use(before, points)
    if before is None:
        lower, upper = points.min(axis=0), points.max(axis=0)
        upper = lower + np.maximum(upper - lower, 1e-6 * np.maximum(np.abs(upper), 1e-3))
    else:
        lower, upper = before.domain.blank.lower, before.domain.blank.upper
    blank = Samples(
        points=points,
        values=np.zeros((len(points), 0)),
        slopes=None,
        weights=np.ones(len(points)) if begins else SMALL / (force / force.max(initial=0.0) + SMALL),
        lower=lower,
        upper=upper,
        noise=free.noise,
    )
    return FitDomain(
        parameters=parameters,
        height=known[:, layout.height(height)],
        height_jacobian=jacobian[:, layout.height(height)],
        begins=begins,
        coordinates=coordinates,
        blank=blank,
        before=before,
    )


def fitted(
    code: Code,
    rows: np.ndarray,
    states: dict[str, np.ndarray],
    free: FreeResponse,
    height: int,
    domain: FitDomain,
    signs: list[contact_regimes.Sign],
    sizes: np.ndarray,
) -> FittedRegime:
    """Fit a regime's quantities and conditions to its states, shapes (states, ...), or correct what is known before."""
    before = domain.before
    known, jacobian = free.polynomial.value_and_gradient(states["parameters"][:, :-1])
    jacobian = np.concatenate([jacobian, np.zeros((*jacobian.shape[:2], 1))], axis=-1)
    values = np.column_stack([states["tip"] - known[:, layout.TIP], states["contact_force"]])
    slopes = np.concatenate(
        [states["tip_jacobian"] - jacobian[:, layout.TIP], states["contact_force_jacobian"][:, None]], axis=1
    )
    if "pad_pressure" in states:
        values = np.column_stack([values, states["pad_pressure"]])
        slopes = np.concatenate([slopes, states["pad_pressure_jacobian"][:, None]], axis=1)
    conditions = None
    if signs:
        pairs = [contact_regimes.sign_values(sign, states, sizes) for sign in signs]
        conditions = domain.fit(
            np.column_stack([pair[0] for pair in pairs]),
            np.stack([pair[1] for pair in pairs], axis=1),
            before.conditions.polynomial if before and before.conditions else None,
            grows=False,
        )
    return FittedRegime(
        code=code,
        rows=rows,
        corner=height,
        domain=domain,
        points=np.concatenate([domain.blank.points, *([before.points] if before else [])]),
        outputs=domain.fit(values, slopes, before.outputs.polynomial if before else None),
        signs=signs,
        conditions=conditions,
    )
