"""Parameters that a log does not determine, and the motions or columns that would add the most information."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from control.calibration.fit import Fit, information
from control.calibration.measured import GROUPS, MOTORS, Measured
from control.calibration.parameters import DETERMINED
from control.log import Log
from rom.brief import brief
from rom.files.csv_table import Heading

POSES, SHARE = 5, 0.8  # of a motion that is tried; of the largest trained tension [-]
LEAST = 0.3  # a component of a parameter in a direction that is named, whatever its deviation [-]
ROUNDING = 1e-3  # a component below this is zero [-]
WITHIN = 0.4  # distance of an object that is tried, over how far the finger reaches towards it [-]


@brief
@dataclass(frozen=True, kw_only=True)
class Undetermined:
    """A combination of parameters that the log does not determine.

    Attributes:
        parameters: names and their components, largest first [-].
        remedy: the motions or columns that would determine it; empty if none of those tried do.
    """

    parameters: dict[str, float]
    remedy: str

    def line(self) -> str:
        """For people."""
        names = " and ".join(name.replace("_", " ") for name in self.parameters)
        one = "is" if len(self.parameters) == 1 else "together are"
        ask = f"to determine it, log {self.remedy}" if self.remedy else "measure it in another way, or do not fit it"
        return f"{names} {one} not determined by this log: {ask}"


def undetermined(measured: Measured, fit: Fit) -> list[Undetermined]:
    """Every direction that the log does not determine, with its remedy."""
    directions, names = list[Undetermined](), measured.unknowns.names
    deviations = np.sqrt(np.diag(fit.covariance)) / measured.unknowns.spreads
    for direction in _single(fit.undetermined[0]):
        least = np.minimum(np.maximum(deviations, ROUNDING), LEAST)  # of components that move a parameter
        order = [k for k in map(int, np.argsort(-np.abs(direction))) if abs(direction[k]) > least[k]]
        components = {names[k]: float(direction[k]) for k in order}
        directions.append(Undetermined(parameters=components, remedy=_remedy(measured, fit, direction)))
    return directions


def _single(directions: np.ndarray) -> np.ndarray:
    """The same space, spanned by directions of few parameters each: its reduced echelon form, rows of length 1."""
    rows = directions.copy()
    for k in range(len(rows)):
        pivot = int(np.argmax(np.abs(rows[k:]).max(axis=0)))
        best = k + int(np.argmax(np.abs(rows[k:, pivot])))
        rows[[k, best]] = rows[[best, k]]
        rows[k] /= rows[k, pivot]
        others = np.arange(len(rows)) != k
        rows[others] -= np.outer(rows[others, pivot], rows[k])
    return rows / np.linalg.norm(rows, axis=1, keepdims=True) if len(rows) else rows


def _remedy(measured: Measured, fit: Fit, direction: np.ndarray) -> str:
    """The first of all motions and columns that determines a direction."""
    spreads = measured.unknowns.spreads
    for words, log, tensions in (*_columns(measured, fit), *_motions(measured, fit)):
        other = replace(measured, log=log, excluded={})
        sigma = {name: fit.noise.get(name, GROUPS[name][1]) for name in other.groups}
        added = information(other, sigma, fit.unknowns, tensions)
        if direction @ (spreads[:, None] * added * spreads) @ direction > DETERMINED**-2:
            return words
    return ""


Tried = Iterator[tuple[str, Log, np.ndarray]]  # words, the log, and the tensions of its poses


def _columns(measured: Measured, fit: Fit) -> Tried:
    """The same poses with one more quantity."""
    log, n = measured.log, len(fit.tensions)
    outputs = measured.outputs(fit.unknowns, fit.tensions)
    added = {
        "tension": ([f"tension {name}" for name in log.tendons], "tension", np.maximum(fit.tensions, 1e-9)),
        "position": ("xyz", "position", outputs.position),
        "orientation": (("qw",), "orientation", outputs.orientation),
        "shortening": ([f"shortening {name}" for name in log.tendons], "shortening", outputs.shortening),
    }
    for group, (headings, name, values) in added.items():
        if group not in measured.groups:
            words = (
                f"the {group} of the tip" if group in ("position", "orientation") else f"the {group} of every tendon"
            )
            yield f"{words} too", _with(log, headings, **{name: values}), fit.tensions
    lower, upper = (float(one[-1]) for one in measured.finger.model.limits)
    if "contact_force" not in measured.groups and "tension" in measured.groups:
        near = np.full(n, lower + WITHIN * (upper - lower))
        log = _with(log, ("contact force", "d"), contact_force=np.ones(n), distance=near)
        yield f"the contact force at d = {1e3 * near[0]:.3g} mm too", log, fit.tensions


def _motions(measured: Measured, fit: Fit) -> Tried:
    """Poses of the log's own columns: every tendon alone, then all together."""
    lower, upper = measured.ends(fit.unknowns)
    tendons = measured.log.tendons
    chosen = [
        (f"{POSES} poses with {name} alone up to", np.arange(len(tendons)) == k) for k, name in enumerate(tendons)
    ]
    chosen.append((f"{POSES} poses with all tendons together up to", np.ones(len(tendons), bool)))
    for words, pulled in chosen:
        levels = np.linspace(SHARE / POSES, SHARE, POSES)[:, None]
        tensions = lower + np.where(pulled, levels, 0.02) * (upper - lower)
        yield f"{words} {SHARE * upper[pulled].max():.3g} N", _imagined(measured.log, len(tensions)), tensions


def _imagined(log: Log, count: int) -> Log:
    """A log with the same columns and a number of poses, whose values do not matter."""
    full = {name: np.ones((count, len(log.tendons))) for name in MOTORS}
    absent = {name: np.full_like(one, np.nan) for name, one in full.items()}
    motors = {name: full[name] if log.has(name) else absent[name] for name in MOTORS}
    axes = [1.0 if log.has(name) else np.nan for name in "xyz"]
    turn = 1.0 if log.has("qw") or log.has("rx") else np.nan
    return log.having(
        lines=np.arange(count),
        time=np.full(count, np.nan),
        **motors,
        position=np.tile(axes, (count, 1)),
        orientation=np.tile([turn, 0.0, 0.0, 0.0], (count, 1)),
        contact_force=np.full(count, np.nan),
        distance=np.full(count, np.nan),
    )


def _with(log: Log, quantities: Sequence[str], **values: np.ndarray) -> Log:
    """The same log with more columns."""
    headings = log.headings | {name: Heading(name, "-") for name in quantities}
    return replace(log, headings=headings).having(**values)
