"""The calibration that a finger carries, as plain data, in tables for people."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from rom.console.table import Table, number, percent, shown

RELATIVE = ("tension", "torque", "contact_force")  # quantities whose noise and errors are relative
UNITS = {"position": "m", "shortening": "m", "orientation": "rad", "angle": "rad"}
FOUND = [f"base_{axis}" for axis in ("x", "y", "z", "rx", "ry", "rz")]  # that no one gives to begin with
STRONG = 0.9  # correlations from which on two parameters are named [-]


def calibration_tables(record: Mapping[str, Any]) -> list[Table | str]:
    """Log that a finger was calibrated on, its parameters, and its errors there; empty without a calibration."""
    if not record:
        return []
    title = f"calibrated on {record['log']} ({record['poses']} poses, {record['date']}, sha256 {record['sha256'][:12]})"
    columns = ", ".join(record["columns"])
    return [
        _parameters(record, title),
        *_correlated(record),
        *record["undetermined_lines"],
        _errors(record),
        f"columns: {columns}; errors are those of predictions from each pose's {record['predicted_from']}",
        *(f"warning: {line}" for line in record["warnings"]),
    ]


def _parameters(record: Mapping[str, Any], title: str) -> Table:
    """Values and intervals."""
    rows = []
    for name, one in record["parameters"].items():
        unit, ends = one["unit"], one["interval"]
        words = ["not determined", ""] if ends is None else [number(end, unit) for end in ends]
        values = ["" if name in FOUND else number(one["start"], unit), number(one["value"], unit)]
        rows.append([name.replace("_", " "), *values, *words, shown(unit)[1]])
    return Table(title=title, header=["parameter", "before", "value", "95 % from", "to", "unit"], rows=rows)


def _correlated(record: Mapping[str, Any]) -> list[str]:
    """Pairs of parameters that depend on each other strongly."""
    names, pairs = list(record["parameters"]), []
    for i, row in enumerate(record["correlations"]):
        pairs += [
            f"{names[j]} and {names[i]} ({row[j]:+.2f})".replace("_", " ")
            for j in range(i)
            if row[j] is not None and abs(row[j]) > STRONG
        ]
    return [f"strongly correlated: {', '.join(pairs)}"] if pairs else []


def _errors(record: Mapping[str, Any]) -> Table:
    """Noise, and residuals of the fit and of predictions."""
    rows = []
    for name, noise in record["noise"].items():
        unit = UNITS.get(name, "")
        fit, left_out = (record["residuals"][kind].get(name) for kind in ("fit", "left_out"))
        cells = [None if one is None else one[key] for one in (fit, left_out) for key in ("median", "p95")]
        written: Callable[[float], str] = percent if name in RELATIVE else partial(number, unit=unit, digits=3)
        words = ["" if one is None else written(one) for one in cells]
        rows.append([name.replace("_", " "), written(noise), *words, "" if name in RELATIVE else shown(unit)[1]])
    header = ["residual", "noise (1 sigma)", "fit, median", "fit, 95 %", "leave-one-out, median", "95 %", "unit"]
    return Table(header=header, rows=rows)
