"""A finger calibrated on a log: its parameters with intervals, its errors on the log, and the calibrated model."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import date
from typing import Any

import numpy as np
from scipy.stats import t as student

from control.calibration.diagnosis.left_out import errors_left_out, sizes
from control.calibration.diagnosis.motions import Undetermined, undetermined
from control.calibration.diagnosis.unexplained import Effect, effects
from control.calibration.fit import Fit
from control.calibration.measured import MOTORS, Measured
from control.calibration.parameters import unit_of
from control.calibration.scaled_finger import ScaledFinger
from rom.brief import brief
from rom.console.table import Table, as_html
from rom.rod.rod import Rod
from rom.rod.scene.scene_of_rod import rescaled
from rom.rod.tables.calibration_tables import calibration_tables

LEVEL = 0.95  # of intervals
# With friction, a pose depends on those before it, which the covariance neglects: errors over deviations, rms, of
# modulus and friction in 14 synthetic logs of 36 poses [-].
HISTORY = 1.9
KEPT = {"position": "position", "orientation": "turn", "shortening": "shortening", "contact_force": "contact_force"}


@brief
@dataclass(frozen=True, kw_only=True)
class Estimate:
    """A parameter.

    Attributes:
        name: modulus, size, density, pulley_radius, friction, base_x ... base_rz.
        unit: Pa, m, kg/m^3, rad or -. The modulus is Young's at small strain; the size is the
            largest side of the section at the clamp.
        start: before the fit.
        value: fitted; the start along directions that the log does not determine.
        interval: that covers the true value with a probability of 95 %; None if the log does not determine it.
    """

    name: str
    unit: str
    start: float
    value: float
    interval: tuple[float, float] | None

    @property
    def determined(self) -> bool:
        """True if the log determines the parameter."""
        return self.interval is not None


@brief
@dataclass(frozen=True, kw_only=True)
class Calibration:
    """The result of a calibration.

    Attributes:
        parameters: the fitted ones.
        correlations: of the fitted parameters, shape (p, p) [-]; nan of those that are not determined.
        undetermined: combinations of parameters that the log does not determine, each with a remedy.
        noise: standard deviation of every quantity, estimated or set by the caller [m, rad], or relative [-].
        errors: sizes of the residuals by quantity: "fit" and "left_out" (leave-one-out), each with median, p95 and max.
        warnings: one line for each outlier, asymmetry, hysteresis, or law that differs.
        poses: how many were used.
        measured, fit: the log before the finger, and the solution.
        rod: the calibrated finger; `save` writes it.
    """

    parameters: Sequence[Estimate]
    correlations: np.ndarray
    undetermined: Sequence[Undetermined]
    noise: Mapping[str, float]
    errors: Mapping[str, Mapping[str, Mapping[str, float]]]
    warnings: Sequence[str]
    poses: int
    measured: Measured = field(repr=False)
    fit: Fit = field(repr=False)
    rod: Rod = field(repr=False)

    def value(self, name: str) -> float:
        """The value of a parameter, in SI units."""
        return next(one.value for one in self.parameters if one.name == name)

    def as_json(self) -> dict[str, Any]:
        """Plain numbers, in SI units."""
        return dict(self.rod.calibration)

    def tables(self) -> list[Table | str]:
        """Tables to print."""
        return calibration_tables(self.rod.calibration)

    def _repr_html_(self) -> str:
        return as_html(self.tables())


def calibrated(measured: Measured, found: Fit, warnings: Sequence[str]) -> Calibration:
    """The result of a fit, with intervals and errors."""
    unexplained = effects(measured, found)
    lacking = undetermined(measured, found)
    warned = [*warnings, *(one.line() for one in unexplained if one.significant)]
    left_out = errors_left_out(measured, found)
    plain = found.residuals / np.where(measured.used, found.whitening, 1.0)
    result = Calibration(
        parameters=_estimates(measured, found, unexplained, lacking),
        correlations=_correlations(found),
        undetermined=lacking,
        noise=found.noise,
        errors={
            "fit": {name: _summary(measured, name, sizes(measured, name, plain)) for name in measured.groups},
            "left_out": {name: _summary(measured, name, one) for name, one in left_out.items()},
        },
        warnings=warned,
        poses=len(found.tensions),
        measured=measured,
        fit=found,
        rod=measured.finger.model.rod,
    )
    return replace(result, rod=_finger(result))


def _estimates(
    measured: Measured, found: Fit, unexplained: Sequence[Effect], lacking: Sequence[Undetermined]
) -> list[Estimate]:
    """The parameters; their intervals include what significant unexplained effects may do to them."""
    unknowns, values = measured.unknowns, measured.unknowns.values(found.unknowns)
    open_ones = {name for one in lacking for name in one.parameters}
    systematic = sum((one.variance * one.moves**2 for one in unexplained), np.zeros(len(unknowns.names)))
    quantiles = _quantiles(measured, found)
    normal = student.isf((1 - LEVEL) / 2, np.inf)
    wider = HISTORY if measured.finger.guides else 1.0
    halves = wider * np.sqrt(quantiles**2 * np.diag(found.covariance) + normal**2 * systematic)
    return [
        Estimate(
            name=name,
            unit=unit_of(name),
            start=unknowns.starts[name],
            value=values[name],
            interval=None if name in open_ones else unknowns.interval(name, values[name], float(half)),
        )
        for name, half in zip(unknowns.names, halves, strict=True)
    ]


def _quantiles(measured: Measured, found: Fit) -> np.ndarray:
    """Quantiles of Student's t for every unknown, shape (p,), by the redundancy of its noise (Welch-Satterthwaite)."""
    columns = np.array(measured.columns)
    influence = np.einsum("pq,nmq->pnm", found.covariance, found.projected) ** 2
    total, squares = influence.sum(axis=(1, 2)), np.zeros(len(influence))
    for name in found.estimated:
        own = columns == name
        squares += influence[..., own].sum(axis=(1, 2)) ** 2 / found.redundancy[:, own].sum()
    freedom = np.where(squares > 0, total**2 / np.maximum(squares, 1e-300), np.inf)
    return student.isf((1 - LEVEL) / 2, np.maximum(freedom, 1.0))


def _correlations(found: Fit) -> np.ndarray:
    deviations = np.sqrt(np.diag(found.covariance))
    known = np.where(deviations > 0, deviations, np.nan)
    return found.covariance / np.outer(known, known)


def _summary(measured: Measured, group: str, errors: np.ndarray) -> dict[str, float]:
    """Median, 95th percentile and maximum; of contact forces relative to the measured ones, where there are any."""
    if group in ("tension", "torque", "contact_force"):
        sizes = np.abs(measured.readings[:, np.array(measured.columns) == group]).max(axis=1)
        errors = errors / np.where(sizes > 0, sizes, np.nan)
    known = errors[np.isfinite(errors)]
    if not len(known):
        return {"count": 0, "median": 0.0, "p95": 0.0, "max": 0.0}
    median, p95, most = (float(one) for one in np.percentile(known, [50, 95, 100]))
    return {"count": len(known), "median": median, "p95": p95, "max": most}


def _finger(result: Calibration) -> Rod:
    """The calibrated finger, which carries the result as plain data."""
    measured, log = result.measured, result.measured.log
    scales, rod = measured.scales(result.fit.unknowns), result.rod
    scene = rescaled(rod.scene, scales.modulus, scales.size)
    if "density" in measured.unknowns.names:
        scene["gravity"] = scene["gravity"] | {"density": scene["gravity"]["density"] * scales.density}
    motor = next(name for name in MOTORS if name in measured.groups)
    record = {
        "log": log.path.name,
        "sha256": log.digest,
        "date": date.today().isoformat(),
        "poses": result.poses,
        "columns": [one.text for one in log.headings.values()],
        "predicted_from": motor,
        "parameters": {
            one.name: {
                "unit": one.unit,
                "start": one.start,
                "value": one.value,
                "interval": None if one.interval is None else list(one.interval),
            }
            for one in result.parameters
        },
        "correlations": [[_number(one) for one in row] for row in result.correlations.tolist()],
        "undetermined": [{"parameters": one.parameters, "remedy": one.remedy} for one in result.undetermined],
        "undetermined_lines": [one.line() for one in result.undetermined],
        "noise": dict(result.noise),
        "residuals": {kind: dict(one) for kind, one in result.errors.items()},
        "warnings": list(result.warnings),
        "errors": _errors_of_answers(result),
    }
    return Rod(elements=rod.elements, scene=scene, accuracy=rod.accuracy, calibration=record)


def _errors_of_answers(result: Calibration) -> dict[str, float]:
    """Errors of the calibrated finger's answers: leave-one-out; at least those without friction, which answers lack."""
    errors = {
        name: one["p95"] for name, one in (result.errors["left_out"] or result.errors["fit"]).items() if one["count"]
    }
    if result.measured.finger.guides:
        plain = replace(result.measured, finger=ScaledFinger(result.measured.finger.model))
        residuals = plain.residuals(result.fit.unknowns, result.fit.tensions).values
        for name in errors:
            errors[name] = max(errors[name], _summary(plain, name, sizes(plain, name, residuals))["p95"])
    return {KEPT[name]: one for name, one in errors.items() if name in KEPT}


def _number(value: float) -> float | None:
    return value if np.isfinite(value) else None
