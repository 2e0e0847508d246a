"""Calibrate a finger on a log."""

import math
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from control.calibration.base import first_base
from control.calibration.calibration import Calibration, calibrated
from control.calibration.checks import check, check_order
from control.calibration.diagnosis.outliers import within_domain, without_outliers
from control.calibration.fit import fit
from control.calibration.measured import GROUPS, RELATIVE, Measured
from control.calibration.parameters import NAMED, PLACE, TURN, Unknowns
from control.calibration.scaled_finger import ScaledFinger
from control.log import Log, read_log
from rom.brief import brief
from rom.dataset.sections.section import extent
from rom.files.csv_table import ANGLES, LENGTHS
from rom.rod.rod import Rod
from rom.rod.touched_segment import TouchedSegment
from rom.rod.weight import gravity_of

FRICTION = 0.1  # of guides, to begin with [-]
DENSITY = 1100.0  # of silicone, where a scene has none [kg/m^3]
NOISE = re.compile(r"\s*(\w+)\s*=\s*([0-9.eE+-]+)\s*(\S+)\s*")


@brief
@dataclass(frozen=True, kw_only=True)
class CalibrationOptions:
    """Options of a calibration.

    Attributes:
        fit: parameters, of modulus, size, base, density, pulley_radius, friction; by default the modulus, and the
            base if a position or an orientation was measured. Friction in the guides needs tensions or torques, and
            the log's lines in the order of the motion, from rest.
        noise: known standard deviations by quantity: position, shortening [m], orientation, angle [rad], tension,
            torque, contact_force [-, relative]. Residuals estimate the others.
        pulley_radius: of the motors [m]; needed if torques or angles were logged.
        gravity: direction of the weight in the clamp's frame, of a finger whose scene has no [gravity], shape (3,) [-].
        ignored: names of the log's columns that are not read.

    Raises:
        ValueError: one line that names option, rule and value.
    """

    fit: Sequence[str] = ()
    noise: Mapping[str, float] = field(default_factory=dict)
    pulley_radius: float | None = None
    gravity: Sequence[float] | None = None
    ignored: Collection[str] = ()

    def __post_init__(self) -> None:
        for name in self.fit:
            if name not in NAMED:
                raise ValueError(f"fit must be of {', '.join(NAMED)}, got {name}")
        for name, value in self.noise.items():
            if name not in GROUPS or not 0 < value < math.inf:
                raise ValueError(f"noise must be above 0, of {', '.join(GROUPS)}, got {name} = {value:g}")
        if self.pulley_radius is not None and not 0 < self.pulley_radius < math.inf:
            raise ValueError(f"pulley_radius must be above 0 m, got {self.pulley_radius:g}")


def calibrate(
    finger: str | Path | TouchedSegment, log: str | Path | Log, options: CalibrationOptions | None = None
) -> Calibration:
    """Fit a finger's parameters to a log.

    All columns have noise, also those of the motors. The tensions of every pose are further unknowns.

    Args:
        finger: its model file, or the finger before its plane; `d` of the log is that plane's.
        log: its CSV file, or the log.
        options: see `CalibrationOptions`.

    Raises:
        ValueError: a log that cannot be fitted: one line with file, line, column, rule and value.

    Example:
        >>> result = calibrate("finger.h5", "log.csv")  # doctest: +SKIP
        >>> result.rod.save("mine.h5")  # doctest: +SKIP
    """
    chosen = options or CalibrationOptions()
    model = finger if isinstance(finger, TouchedSegment) else TouchedSegment.load(finger)
    read = log if isinstance(log, Log) else read_log(log, model.rod.names, chosen.ignored)
    measured = _before(model, read, chosen)
    check(measured)
    if any(name in measured.unknowns.names for name in TURN):
        starts = {**measured.unknowns.starts, **first_base(measured)}
        measured = replace(measured, unknowns=replace(measured.unknowns, starts=starts))
    fitted = fit(measured, chosen.noise)
    check_order(measured, fitted)
    measured, fitted, beyond = within_domain(measured, fitted, chosen.noise)
    measured, fitted, outlying = without_outliers(measured, fitted, chosen.noise)
    return calibrated(measured, fitted, [*beyond, *outlying])


def _before(model: TouchedSegment, log: Log, options: CalibrationOptions) -> Measured:
    """A log and its finger, with the unknowns of the fit."""
    seen = any(map(log.has, ("x", "y", "z"))), log.has("qw") or log.has("rx")
    named = list(options.fit) or ["modulus", *(["base"] if any(seen) else [])]
    fitted = [part for name in dict.fromkeys(named) for part in NAMED[name]]
    if not options.fit and not seen[0]:
        fitted = [name for name in fitted if name not in PLACE]
    if (log.has("torque") or log.has("angle") or "pulley_radius" in fitted) and options.pulley_radius is None:
        raise ValueError(
            f"pulley_radius must be a radius [m] for torques or angles in {log.path}, and to begin its fit, got none"
        )
    if "friction" in fitted and not (log.has("tension") or log.has("torque")):
        raise ValueError(f"friction must be fitted to tensions or torques, got neither in {log.path}")
    rod = model.rod
    if "density" in fitted:
        rod = _weighing(rod, options.gravity)
    geometry = rod.scene["geometry"]
    starts = {
        "modulus": rod.segments[0].young_modulus,
        "size": extent(rod.scene),
        "density": rod.scene.get("gravity", {}).get("density", DENSITY),
        "pulley_radius": options.pulley_radius or 1.0,
        "friction": FRICTION if "friction" in fitted else 0.0,
        **dict.fromkeys((*PLACE, *TURN), 0.0),
    }
    unknowns = Unknowns(names=fitted, starts=starts, length=sum(geometry["segments"]))
    finger = ScaledFinger(replace(model, rod=rod), weight="density" in fitted, guides="friction" in fitted)
    return Measured(log=log, finger=finger, unknowns=unknowns)


def _weighing(rod: Rod, direction: Sequence[float] | None) -> Rod:
    """The finger with its scene's [gravity], or with a density to begin with."""
    if "gravity" in rod.scene:
        return rod if direction is None else rod.with_gravity(direction)
    if direction is None:
        raise ValueError(
            "gravity must be the direction of the weight in the clamp's frame to fit the density, got none"
        )
    gravity = gravity_of({"density": DENSITY, "direction": [float(part) for part in direction]})
    return Rod(elements=rod.elements, scene=rod.scene | {"gravity": gravity}, accuracy=rod.accuracy)


def noise_of(text: str) -> tuple[str, float]:
    """A quantity and its noise, of text such as "position=0.5mm", "orientation=1deg" or "tension=2%".

    Raises:
        ValueError: another text.
    """
    parts = NOISE.fullmatch(text)
    if parts is not None and parts[1] in GROUPS:
        units = LENGTHS if GROUPS[parts[1]][0] == "m" else ANGLES
        if parts[1] in RELATIVE:
            units = {"%": 0.01}
        if parts[3] in units:
            try:
                return parts[1], float(parts[2]) * units[parts[3]]
            except ValueError:
                pass
    raise ValueError(f"noise must be such as position=0.5mm, orientation=1deg or tension=2%, got {text!r}")
