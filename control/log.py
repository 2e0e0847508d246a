"""A log of a finger: what its motors did and what was measured, read from a CSV file; row by row in SI units."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rom.brief import brief
from rom.files.atomic_file import write_whole
from rom.files.csv_table import (
    ANGLES,
    FORCES,
    LENGTHS,
    MOMENTS,
    PLAIN,
    TIMES,
    CsvTable,
    Heading,
    Refused,
    factor,
    heading,
)
from rom.files.csv_table import read_table as read_cells

# A tendon's column is named by the tendon; its unit says what was measured.
TENDON = {"tension": FORCES, "shortening": LENGTHS, "torque": MOMENTS, "angle": ANGLES}
QUATERNION, VECTOR = ("qw", "qx", "qy", "qz"), ("rx", "ry", "rz")
OTHERS = {
    "t": TIMES,
    **dict.fromkeys("xyz", LENGTHS),
    **dict.fromkeys(QUATERNION, PLAIN),
    **dict.fromkeys(VECTOR, ANGLES),
    "contact force": FORCES,
    "d": LENGTHS,
}
TOGETHER = QUATERNION, VECTOR  # columns that must all be present or all be absent
BY_ROW = ("lines", "time", *TENDON, "position", "orientation", "contact_force", "distance")  # fields of a value a row
UNIT = 0.05  # how far the norm of a measured quaternion may be from 1 [-]


@brief
@dataclass(frozen=True, kw_only=True)
class Log:
    """Measurements at n moments or poses, in SI units; nan where a cell is empty or a column is absent.

    Attributes:
        path: the file.
        digest: SHA-256 of the file.
        lines: of the file, one for each row, shape (n,).
        tendons: their names, t.
        headings: of the columns as the file names them, by quantity: "tension F1", "x", "contact force", and so on.
        time: [s], shape (n,).
        tension: at the motors, shape (n, t) [N].
        shortening: how far the motors have pulled every tendon in, shape (n, t) [m].
        torque: of the motors, shape (n, t) [N m].
        angle: of the motors, shape (n, t) [rad].
        position: of the tip plate's centre, in the frame of whoever measured it, shape (n, 3) [m].
        orientation: of the tip plate's frame, as unit quaternions w, x, y, z, shape (n, 4) [-].
        contact_force: of the object on the finger, shape (n,) [N].
        distance: d of the object, shape (n,) [m].
    """

    path: Path
    digest: str
    lines: np.ndarray
    tendons: Sequence[str]
    headings: dict[str, Heading]
    time: np.ndarray
    tension: np.ndarray = field(repr=False)
    shortening: np.ndarray = field(repr=False)
    torque: np.ndarray = field(repr=False)
    angle: np.ndarray = field(repr=False)
    position: np.ndarray = field(repr=False)
    orientation: np.ndarray = field(repr=False)
    contact_force: np.ndarray = field(repr=False)
    distance: np.ndarray = field(repr=False)

    def has(self, quantity: str) -> bool:
        """True if the file has a column of a quantity, such as "tension", "x", "qw" or "contact force"."""
        return any(name == quantity or name.split()[0] == quantity for name in self.headings)

    def only(self, rows: np.ndarray) -> Log:
        """The same with some of the rows, by their numbers or a mask."""
        return replace(self, **{one.name: getattr(self, one.name)[rows] for one in fields(self) if one.name in BY_ROW})

    def having(self, **values: np.ndarray) -> Log:
        """The same with other values of some quantities."""
        changed: dict[str, Any] = dict(values)
        return replace(self, **changed)

    def where(self, row: int, quantity: str = "") -> str:
        """The beginning of a message about a row, and about one of its columns."""
        column = f", {self.headings[quantity].text}" if quantity in self.headings else ""
        return f"{self.path}, line {self.lines[row]}{column}"


def read_log(path: str | Path, tendons: Sequence[str], ignored: Collection[str] = ()) -> Log:
    """Read a log.

    The first line names every column and its unit, such as `F1 [N],F2 [N],x [mm],y [mm],z [mm]`. Columns may have any
    order. Lines that begin with # are comments. An empty cell is a value that was not measured.

    Args:
        path: the file, in UTF-8.
        tendons: names of the finger's tendons.
        ignored: names of columns that are not read.

    Raises:
        ValueError: one line with file, line, column, rule and value.

    Example:
        >>> read_log("log.csv", ["F1", "F2"]).position  # doctest: +SKIP
    """
    table = read_cells(path)
    columns = _columns(table, tendons, ignored)
    numbers = _numbers(table, columns)
    n = len(table.rows)

    def values(*names: str) -> np.ndarray:
        return np.column_stack([numbers.get(name, np.full(n, np.nan)) for name in names])

    of_tendons = {quantity: values(*(f"{quantity} {name}" for name in tendons)) for quantity in TENDON}
    log = Log(
        path=Path(path),
        digest=hashlib.sha256(Path(path).read_bytes()).hexdigest(),
        lines=np.array([line for line, _ in table.rows], int),
        tendons=list(tendons),
        headings={quantity: column for quantity, (_, column, _) in columns.items()},
        time=values("t")[:, 0],
        **of_tendons,
        position=values("x", "y", "z"),
        orientation=values(*QUATERNION) if "qw" in columns else _quaternions(values(*VECTOR)),
        contact_force=values("contact force")[:, 0],
        distance=values("d")[:, 0],
    )
    return _checked(log)


def write_log(path: str | Path, columns: Mapping[str, ArrayLike], comment: str = "") -> Path:
    """Write a log that `read_log` reads; nan becomes an empty cell.

    Args:
        path: the file.
        columns: values by heading, such as "F1 [N]", in its unit, shape (n,).
        comment: a first line.

    Returns:
        the path.
    """
    rows = np.column_stack([np.asarray(values, float) for values in columns.values()]).tolist()
    lines = [f"# {comment}"] if comment else []
    lines += [",".join(columns), *(",".join("" if math.isnan(one) else repr(one) for one in row) for row in rows)]
    text = "\n".join([*lines, ""]).encode()
    write_whole(Path(path), lambda stream: stream.write(text))
    return Path(path)


def _columns(
    table: CsvTable, tendons: Sequence[str], ignored: Collection[str]
) -> dict[str, tuple[int, Heading, float]]:
    """Position, heading and factor of every column, by its quantity."""
    where, columns = table.where(table.first), dict[str, tuple[int, Heading, float]]()
    for k, cell in enumerate(table.names):
        column = heading(cell)
        if column.name in ignored:
            continue
        quantity, scale = _quantity(where, column, tendons)
        if quantity in columns:
            raise Refused(
                f"{where}: must have one column of {quantity}, got {columns[quantity][1].text}, {column.text}"
            )
        columns[quantity] = k, column, scale
    for names in (*TOGETHER, *([f"{quantity} {name}" for name in tendons] for quantity in TENDON)):
        present = [name for name in names if name in columns]
        if present and len(present) < len(names):
            lacking = next(name for name in names if name not in columns)
            raise Refused(f"{where}: must have all of {', '.join(names)} or none, got no {lacking}")
    if "qw" in columns and "rx" in columns:
        raise Refused(f"{where}: must have an orientation once, got {', '.join((*QUATERNION, *VECTOR))}")
    return columns


def _quantity(where: str, column: Heading, tendons: Sequence[str]) -> tuple[str, float]:
    """The quantity of a column, and the factor of its unit."""
    if column.name in tendons:
        for quantity, units in TENDON.items():
            if column.unit in units:
                return f"{quantity} {column.name}", units[column.unit]
        return column.name, factor(
            where, column, {name: one for units in TENDON.values() for name, one in units.items()}
        )
    if column.name not in OTHERS:
        known = ", ".join((*tendons, *OTHERS))
        raise Refused(f"{where}: columns must be of {known}, got {column.text or 'no name'}; --ignore leaves one out")
    return column.name, factor(where, column, OTHERS[column.name])


def _numbers(table: CsvTable, columns: dict[str, tuple[int, Heading, float]]) -> dict[str, np.ndarray]:
    """Every column's numbers in SI units, shape (n,), by its quantity; nan of empty cells."""
    numbers = {quantity: np.full(len(table.rows), np.nan) for quantity in columns}
    for row, (line, cells) in enumerate(table.rows):
        if len(cells) != len(table.names):
            raise Refused(
                f"{table.where(line)}: must have {len(table.names)} cells, as the first line, got {len(cells)}"
            )
        for quantity, (k, column, scale) in columns.items():
            if cells[k].strip():
                numbers[quantity][row] = scale * table.number(line, column, cells[k])
    return numbers


def _checked(log: Log) -> Log:
    """The log, whose times and orientations are checked; quaternions become unit ones.

    Raises:
        Refused: no rows, a time that is not after the one before, or a quaternion that is none.
    """
    if not len(log.lines):
        raise Refused(f"{log.path}: must have a line of numbers, got none")
    late = np.flatnonzero(np.diff(log.time) <= 0)
    if len(late):
        row = late[0] + 1
        raise Refused(f"{log.where(row, 't')}: must be after the line before, got {log.time[row]:g} s")
    norms = np.linalg.norm(log.orientation, axis=1)
    wrong = np.flatnonzero(np.abs(norms - 1) > UNIT)
    if len(wrong):
        names = ", ".join(QUATERNION)
        raise Refused(f"{log.where(wrong[0])}: {names} must be a unit quaternion, got length {norms[wrong[0]]:.3g}")
    log.orientation[:] /= norms[:, None]
    return log


def _quaternions(vectors: np.ndarray) -> np.ndarray:
    """Unit quaternions w, x, y, z, shape (n, 4) [-], of rotation vectors, shape (n, 3) [rad]."""
    angles = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.hstack([np.cos(angles / 2), np.sinc(angles / (2 * np.pi)) / 2 * vectors])
