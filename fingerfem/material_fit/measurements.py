"""Tests of rubber, read from a CSV file: stretch or strain, and nominal stress, with their units in the header."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fingerfem.scene.laws.stability import MODES
from rom.brief import brief
from rom.files.csv_table import CsvTable, Heading, Refused, factor, heading, read_table

NAMES = {**{mode: mode for mode in MODES}, "biaxial": "equibiaxial", "pure shear": "planar"}
STRAIN_UNITS = {"-": 1.0, "1": 1.0, "mm/mm": 1.0, "m/m": 1.0, "%": 0.01}
STRESS_UNITS = {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "N/mm2": 1e6, "N/mm^2": 1e6, "N/mm²": 1e6, "psi": 6894.757293168}
KINDS = {"stress": "stress", "stretch": "elongation", "strain": "elongation"}  # of columns, by words in their names
TRUE = re.compile(r"\b(true|log|logarithmic|hencky|cauchy)\b")
STRETCHES = (0.05, 20.0)  # that a law's key `stretches` may have [-]
FEWEST = 8  # different stretches of a test: Ogden's law of three terms has six constants
OPPOSITE = 0.02  # of the peak: noise of a stress near rest may have the other sign [-]


@brief
@dataclass(frozen=True, kw_only=True)
class Measurement:
    """A test of incompressible rubber along one path of deformation.

    Attributes:
        mode: uniaxial, equibiaxial or planar, see `fingerfem.scene.laws.stability.MODES`.
        stretch: along the pull, ascending, shape (points,) [-].
        stress: force over the area at rest, shape (points,) [Pa].
    """

    mode: str
    stretch: np.ndarray
    stress: np.ndarray

    @property
    def peak(self) -> float:
        """Largest size of the stress [Pa]."""
        return float(np.abs(self.stress).max())


class Column(NamedTuple):
    """A column of numbers: where it is, its unit in the file, and the unit's factor."""

    name: str
    position: int
    unit: str
    factor: float


class Header(NamedTuple):
    """Columns that the first line names; without a column of tests, all rows have `mode`."""

    elongation: Column
    stress: Column
    test: int | None
    mode: str | None


class Row(NamedTuple):
    """A point of a test and its line in the file."""

    mode: str
    stretch: float
    stress: float
    line: int


def read_measurements(path: str | Path, test: str | None = None, to: float | None = None) -> list[Measurement]:
    """Read the tests of a file.

    The first line that does not begin with # names the columns, such as `test,stretch [-],nominal stress [MPa]`.
    Columns with other names are not read. Cells are parted by tabs, semicolons or commas. With tabs or semicolons,
    decimal commas are read, too.

    Args:
        path: the file, in UTF-8.
        test: the kind of test of all rows, of a file that does not name it.
        to: reads stretches from 1 / to to this one alone [-].

    Raises:
        ValueError: one line with file, line, rule and value.
    """
    if to is not None and not to > 1:
        raise ValueError(f"to must be a stretch above 1, got {to:g}")
    table = read_table(path)
    header = _header(table, test)
    rows = list(_rows(table, header))
    kept = [row for row in rows if to is None or 1 / to <= row.stretch <= to]
    modes = list(dict.fromkeys(row.mode for row in rows)) or [header.mode or "a"]
    return [_measurement(path, mode, [row for row in kept if row.mode == mode]) for mode in modes]


def _header(table: CsvTable, test: str | None) -> Header:
    """Columns by their names in the table's first line."""
    where, names = table.where(table.first), table.names
    columns: dict[str, list[int]] = {"test": [], "elongation": [], "stress": []}
    true = []
    for index, name in enumerate(names):
        lower = name.lower()
        kind = next((kind for word, kind in KINDS.items() if word in lower), None)
        if kind and TRUE.search(lower):
            true.append(name.strip())
        elif kind or lower.strip() == "test":
            columns[kind or "test"].append(index)
    for kind, title in (("elongation", "a stretch or a nominal strain"), ("stress", "a nominal stress")):
        if len(columns[kind]) != 1:
            given = [names[index].strip() for index in columns[kind]] or true or [name.strip() for name in names]
            raise Refused(f"{where}: must name one column of {title}, got {', '.join(given)}")
    elongation, stress = (names[columns[kind][0]] for kind in ("elongation", "stress"))
    modes = {mode for word, mode in NAMES.items() if re.search(rf"\b{word}\b", f"{elongation} {stress}".lower())}
    ways = [*columns["test"], *modes, *([] if test is None else [test])]
    if len(ways) != 1:
        rule = f"must name the test once, {', '.join(MODES)}: by a column test, in a column's name, or by --test"
        raise Refused(f"{where}: {rule}, got {len(ways)} of these")
    return Header(
        elongation=_column(where, elongation, columns["elongation"][0], STRAIN_UNITS),
        stress=_column(where, stress, columns["stress"][0], STRESS_UNITS),
        test=columns["test"][0] if columns["test"] else None,
        mode=next(iter(modes), None) if test is None else _mode("test", test),
    )


def _column(where: str, name: str, index: int, units: Mapping[str, float]) -> Column:
    """A column by its name, which ends in a unit."""
    parts = heading(name)
    scale = factor(where, parts, units)
    strain = "stretch" if "stretch" in parts.name.lower() else "strain"
    return Column("stress" if units is STRESS_UNITS else strain, index, parts.unit, scale)


def _mode(name: str, text: str) -> str:
    """The mode of a test's name."""
    mode = NAMES.get(" ".join(text.lower().replace("_", " ").replace("-", " ").split()))
    if mode is None:
        raise Refused(f"{name} must be {', '.join(MODES)} or pure shear (planar), got {text.strip()!r}")
    return mode


def _rows(table: CsvTable, header: Header) -> Iterator[Row]:
    """The points of all lines."""
    last = max(header.elongation.position, header.stress.position, header.test or 0)
    for number, cells in table.rows:
        where = table.where(number)
        if len(cells) <= last:
            raise Refused(f"{where}: must have at least {last + 1} cells, got {len(cells)}")
        elongation, stress = (
            table.number(number, Heading(one.name, one.unit), cells[one.position]) * one.factor
            for one in (header.elongation, header.stress)
        )
        stretch = elongation + (header.elongation.name == "strain")
        low, high = STRETCHES
        if not low < stretch < high:
            raise Refused(f"{where}: stretch must be above {low:g} and below {high:g}, got {stretch:g}")
        mode = header.mode or _mode(f"{where}: test", cells[header.test or 0])
        yield Row(mode, stretch, stress, number)


def _measurement(path: str | Path, mode: str, rows: Sequence[Row]) -> Measurement:
    """The points of one test, checked together."""
    if (different := len({row.stretch for row in rows})) < FEWEST:
        raise Refused(f"{path}: {mode} test must have at least {FEWEST} different stretches, got {different}")
    peak = max(abs(row.stress) for row in rows)
    if peak == 0:
        raise Refused(f"{path}: {mode} test must have a stress, got 0 at all points")
    for row in rows:
        same = row.stress * (1 if row.stretch > 1 else -1) if row.stretch != 1 else -abs(row.stress)
        if same < -OPPOSITE * peak:
            rule = f"above 0 in tension, below 0 in compression and 0 at rest, within {OPPOSITE:.0%} of the peak"
            given = f"{row.stress:.4g} Pa at a stretch of {row.stretch:.6g}"
            raise Refused(f"{path}, line {row.line}: stress must be {rule}, got {given}")
    ordered = sorted(rows, key=lambda row: row.stretch)
    return Measurement(
        mode=mode, stretch=np.array([row.stretch for row in ordered]), stress=np.array([row.stress for row in ordered])
    )
