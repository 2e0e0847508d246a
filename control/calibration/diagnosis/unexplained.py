"""Effects that no fitted parameter explains: their size by the residuals, and what they may do to the parameters.

An effect is a change c of the model's values, in whitened columns, times an unknown factor g. With residuals r, the
projector P of the tensions, and H, B of `control.calibration.fit` (a score test, C. R. Rao, 1948):

    g = -c^T P r / v,   v = c^T P c - b^T H^-1 b,   b = B^T P c,   var g = 1 / v.

Left out of the fit, it moves the unknowns by H^-1 b g.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from control.calibration.fit import Fit
from control.calibration.measured import MOTORS, Measured
from rom.brief import brief

SURE, WORTH = 3.3, 0.01  # standard deviations [-], and least size of an effect that is reported [-]
MOVED = 0.01  # of the largest value: a smaller change from row to row has no direction [-]


@brief
@dataclass(frozen=True, kw_only=True)
class Effect:
    """An effect on what the motors show.

    Attributes:
        name: asymmetry of a tendon, hysteresis or law.
        tendon: which, of an asymmetry.
        size: g [-].
        deviation: its standard deviation [-].
        moves: how the unknowns would change per unit of g, shape (p,).
    """

    name: str
    tendon: str
    size: float
    deviation: float
    moves: np.ndarray

    @property
    def significant(self) -> bool:
        """True if it is worth a warning."""
        return abs(self.size) > max(SURE * self.deviation, WORTH)

    @property
    def variance(self) -> float:
        """An estimate of g^2 without what noise adds; 0 of an effect that is not significant [-]."""
        return max(self.size**2 - self.deviation**2, 0.0) if self.significant else 0.0

    def line(self) -> str:
        """For people."""
        share, noise = f"{100 * abs(self.size):.2g} %", f"± {196 * self.deviation:.2g} %"
        if self.name == "hysteresis":
            way = "less" if self.size > 0 else "more"
            return (
                f"hysteresis: at equal readings, tendons act {share} ({noise}) {way} after rising than after falling; "
                "no fitted parameter explains this"
            )
        if self.name == "asymmetry":
            way = "less" if self.size > 0 else "more"
            return (
                f"asymmetry: at equal readings, {self.tendon} acts {share} ({noise}) {way} than the other tendons; "
                "no fitted parameter explains this: check its guide and its zero"
            )
        way = "stiffer" if self.size > 0 else "softer"
        return (
            f"law: the finger is {share} ({noise}) {way} at the largest readings than at the mean; "
            "the rubber's law differs from the model's"
        )


def effects(measured: Measured, fit: Fit) -> list[Effect]:
    """Every effect that the log can show."""
    motor = next((name for name in MOTORS if name in measured.groups), None)
    shown = []
    for name, tendon, shares in _candidates(measured, motor):
        change = np.zeros_like(fit.residuals)
        own = np.array(measured.columns) == motor
        change[:, own] = shares
        change = np.where(measured.used, change * fit.whitening, 0.0)
        through = np.einsum("nij,nj->ni", fit.projector, change)
        moves = np.einsum("nmp,nm->p", fit.projected, through)
        against = float((through**2).sum())
        information = against - float(moves @ fit.covariance @ moves)
        if information > 1e-6 * against > 0:
            size = -float((through * fit.residuals).sum()) / information
            shown.append(
                Effect(
                    name=name,
                    tendon=tendon,
                    size=size,
                    deviation=information**-0.5,
                    moves=fit.covariance @ moves,
                )
            )
    return shown


def _candidates(measured: Measured, motor: str | None) -> Iterator[tuple[str, str, np.ndarray]]:
    """Names, tendons, and changes of the motors' readings per unit of an effect, shape (n, t)."""
    if motor is None:
        return
    readings = np.nan_to_num(getattr(measured.log, motor))
    tendons, largest = measured.log.tendons, max(float(np.abs(readings).max()), 1e-300)
    rising = np.sign(np.where(np.abs(steps := np.diff(readings, axis=0)) > MOVED * largest, steps, 0.0))
    yield "hysteresis", "", readings * np.vstack([np.zeros((1, len(tendons))), rising])
    yield "law", "", readings * (readings - readings.mean()) / (largest - readings.mean() or 1.0)
    for k, name in enumerate(tendons[: None if len(tendons) > 2 else 1]):
        if len(tendons) > 1:
            yield "asymmetry", name, readings * ((np.arange(len(tendons)) == k) - 1 / len(tendons))
