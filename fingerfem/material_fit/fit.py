"""Fits laws to the points of tests, measures each fit on points that were left out, and chooses one of the laws."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import ValidationError

from fingerfem.material_fit.doubts import doubts
from fingerfem.material_fit.linear import fit_linear
from fingerfem.material_fit.measurements import Measurement
from fingerfem.material_fit.ogden import fit_ogden
from fingerfem.material_fit.points import FOLDS, Points, points_of
from fingerfem.material_fit.stresses import nominal_stress
from fingerfem.scene.laws import REGISTERED, Law
from fingerfem.scene.laws.stability import first_loss
from fingerfem.scene.toml_file import one_line
from rom.brief import brief

# Laws that are linear in their constants, and Ogden's.
CONSTANTS = {"neo-hookean": ("C1",), "mooney-rivlin": ("C10", "C01"), "yeoh": ("C1", "C2", "C3")}
LAWS = (*CONSTANTS, "ogden")
WIDEST = (0.2, 5.0)  # principal stretches between which a loss of stability is searched [-]
DIGITS = 8  # of a constant
# A fit takes the rubber as incompressible: at a stretch of 2 the law's stress is lower by 2 % with 0.49, 0.2 % with
# 0.499 [-].
POISSON = (0.49, 0.49999)
WORST = 0.2  # error on points left out, over the peak stress, above which no law is usable [-]
ENOUGH = 1e-3  # of the peak: a smaller difference of errors does not pay for another constant [-]


@brief
@dataclass(frozen=True, kw_only=True)
class Errors:
    """Law minus measurement, over the largest stress of each test [-].

    Attributes:
        rms: root of the weighted mean square, of all tests together.
        largest: of all points.
        by_mode: both, of each test.
    """

    rms: float
    largest: float
    by_mode: dict[str, tuple[float, float]]


@brief
@dataclass(frozen=True, kw_only=True)
class Fit:
    """A law that was fitted.

    Attributes:
        name: of the law.
        law: with its constants; None if scenes would refuse it.
        reason: of the refusal.
        is_constrained: whether least squares without a constraint gave a law that is not stable within its data.
        constants: how many were fitted.
        errors: on all points.
        left_out: on points that were left out of the fit, each once.
        loss: mode and stretch of the first loss of stability within WIDEST; None if there is none.
    """

    name: str
    law: Law | None = None
    reason: str = ""
    is_constrained: bool = False
    constants: int = 0
    errors: Errors | None = None
    left_out: Errors | None = None
    loss: tuple[str, float] | None = None


@brief
@dataclass(frozen=True, kw_only=True)
class Comparison:
    """Fits of several laws to the same tests.

    Attributes:
        measurements: the tests.
        stretches: lowest and highest principal stretch of the data [-].
        fits: in the order of LAWS.
        chosen: the best of them; None if no law is usable.
        doubts: what is unlikely in the tests and in the best law, each as one line.
    """

    measurements: Sequence[Measurement]
    stretches: tuple[float, float]
    fits: Sequence[Fit]
    chosen: Fit | None
    doubts: Sequence[str] = ()


def compare(
    measurements: Sequence[Measurement], names: Sequence[str] = LAWS, terms: int = 2, nu: float = 0.499
) -> Comparison:
    """Fit laws and choose one: of those within ENOUGH of the least error on points left out, that of fewest constants.

    Args:
        measurements: the tests.
        names: of the laws.
        terms: of Ogden's law.
        nu: Poisson's ratio, which the tests do not measure [-].

    Raises:
        ValueError: no such law, or nu outside POISSON.
    """
    if not POISSON[0] <= nu <= POISSON[1]:
        low, high = POISSON
        raise ValueError(f"nu must be from {low:g} to {high:g}, as the fit takes the volume as constant, got {nu:g}")
    if wrong := [name for name in names if name not in LAWS]:
        raise ValueError(f"law must be one of {', '.join(LAWS)}, got {wrong[0]}")
    points = points_of(measurements)
    low, high = points.principal
    stretches = round(low, 4), round(high, 4)
    fits = [fit(name, points, terms, nu, stretches) for name in names]
    usable = [one for one in fits if one.left_out is not None]
    least = min((one.left_out.rms for one in usable if one.left_out), default=0.0)
    near = [one for one in usable if one.left_out and one.left_out.rms <= least + ENOUGH]
    best = min(near, key=lambda one: one.constants, default=None)
    return Comparison(
        measurements=measurements,
        stretches=stretches,
        fits=fits,
        chosen=best if least <= WORST else None,
        doubts=doubts(measurements, best),
    )


def fit(name: str, points: Points, terms: int, nu: float, stretches: tuple[float, float]) -> Fit:
    """Fit one law; among the stable ones if the best of all is not stable."""
    low, high = unchecked(name, {}).limits
    if not low <= stretches[0] < stretches[1] <= high:
        data = f"{stretches[0]:g} to {stretches[1]:g}"
        reason = f"data must be at principal stretches from {low:g} to {high:g}, got {data}; fit fewer by --to"
        return Fit(name=name, reason=reason)
    reason = ""
    for stable in (None, stretches) if name in CONSTANTS else (None,):  # Ogden's law is fitted among stable ones
        table = fitted(name, points, terms, stable)
        try:
            law = law_of(name, table, nu, stretches)
        except ValidationError as error:
            reason = one_line(error)
            continue
        return Fit(
            name=name,
            law=law,
            is_constrained=stable is not None,
            constants=sum(len(value) if isinstance(value, list) else 1 for value in table.values()),
            errors=errors(points, stress(law, points)),
            left_out=errors(points, predicted(name, points, terms, stable)),
            loss=None if law.is_always_stable else first_loss(law, WIDEST),
        )
    return Fit(name=name, reason=reason)


def fitted(name: str, points: Points, terms: int, stable: tuple[float, float] | None) -> dict[str, Any]:
    """The constants of a law but D1, rounded."""
    linear = name in CONSTANTS
    table = fit_linear(REGISTERED[name], CONSTANTS[name], points, stable) if linear else fit_ogden(points, terms)
    return {key: _rounded(value) for key, value in table.items()}


def _rounded(value: Any) -> Any:
    """A constant, or a list of them, in DIGITS."""
    return [_rounded(one) for one in value] if isinstance(value, list) else float(f"{value:.{DIGITS}g}")


def law_of(name: str, table: dict[str, Any], nu: float, stretches: tuple[float, float]) -> Law:
    """The law with these constants and a bulk modulus K = 2 mu (1 + nu) / (3 - 6 nu).

    Raises:
        ValidationError: scenes would refuse it.
    """
    own = unchecked(name, table)
    bulk = own.shear_modulus * (2 + 2 * nu) / (3 - 6 * nu) - own.bulk_modulus  # that is missing: 2 / D1
    D1 = _rounded(2 / bulk) if bulk else np.inf
    return REGISTERED[name].model_validate({"law": name, **table, "D1": D1, "stretches": list(stretches)})


def unchecked(name: str, table: dict[str, Any]) -> Law:
    """The law with these constants and no resistance to a change of volume, which scenes would refuse."""
    return REGISTERED[name].model_construct(law=name, **table, D1=np.inf)


def predicted(name: str, points: Points, terms: int, stable: tuple[float, float] | None) -> np.ndarray:
    """The stress of each point by a fit to those of other folds, shape (points,) [Pa]."""
    stresses = np.empty(len(points.stress))
    for fold in range(FOLDS):
        left_out = points.fold == fold
        law = unchecked(name, fitted(name, points.where(~left_out), terms, stable))
        stresses[left_out] = stress(law, points.where(left_out))
    return stresses


def stress(law: Law, points: Points) -> np.ndarray:
    """Nominal stress of a law at the points, shape (points,) [Pa]."""
    return points.by_mode(lambda mode, stretch: nominal_stress(law, mode, stretch))


def errors(points: Points, stress: np.ndarray) -> Errors:
    """Errors of nominal stresses at the points, shape (points,) [Pa]."""
    relative = (stress - points.stress) / points.peak

    def of(chosen: np.ndarray) -> tuple[float, float]:
        weight = points.weight[chosen]
        return float(np.sqrt(weight @ relative[chosen] ** 2 / weight.sum())), float(np.abs(relative[chosen]).max())

    rms, largest = of(np.full(len(stress), True))
    by_mode = {mode: of(points.mode == mode) for mode in dict.fromkeys(points.mode.tolist())}
    return Errors(rms=rms, largest=largest, by_mode=by_mode)
