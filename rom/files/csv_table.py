"""Tables that users write: CSV files whose first line names every column and its unit."""

import csv
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from rom.brief import brief
from rom.files.file_kinds import uses_of

LENGTHS = {"mm": 1e-3, "m": 1.0, "cm": 1e-2, "um": 1e-6, "µm": 1e-6}
FORCES = {"N": 1.0, "mN": 1e-3, "kN": 1e3}
MOMENTS = {"N mm": 1e-3, "N m": 1.0, "Nmm": 1e-3, "Nm": 1.0, "mN m": 1e-3}
ANGLES = {"deg": math.pi / 180, "rad": 1.0, "°": math.pi / 180}
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6}
PLAIN = {"-": 1.0, "1": 1.0}


class Refused(ValueError):
    """Input of a file that is not accepted: one line with file, line, rule and value."""


class Heading(NamedTuple):
    """The name of a column, and its unit as the file writes it; no unit is an empty string."""

    name: str
    unit: str

    @property
    def text(self) -> str:
        """Heading as in the file."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


@brief
@dataclass(frozen=True)
class CsvTable:
    """The cells of a file.

    Attributes:
        path: the file.
        first: number of the line that names the columns.
        names: the cells of that line.
        rows: number of every other line that is neither empty nor a comment, and its cells.
        decimal_comma: whether numbers may have one.
    """

    path: Path
    first: int
    names: list[str]
    rows: list[tuple[int, list[str]]]
    decimal_comma: bool

    def where(self, line: int) -> str:
        """The beginning of a message about a line."""
        return f"{self.path}, line {line}"

    def number(self, line: int, column: Heading, cell: str) -> float:
        """A cell's number, in the column's unit.

        Raises:
            Refused: not a finite number.
        """
        text = cell.strip()
        try:
            number = float(text.replace(",", ".") if self.decimal_comma else text)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            rule = f"{column.name} must be a finite number, [{column.unit}]"
            raise Refused(f"{self.where(line)}: {rule}, got {text!r}") from None
        return number


def read_table(path: str | Path) -> CsvTable:
    """Read the cells of a file.

    The first line that does not begin with # names the columns. Cells are parted by tabs, semicolons or commas. With
    tabs or semicolons, decimal commas are read, too.

    Args:
        path: the file, in UTF-8.

    Raises:
        Refused: not such a file: one line with file, line and rule.
    """
    if use := uses_of(path):
        raise Refused(f"{path}: must be a CSV file{use}")
    try:
        lines = Path(path).read_text("utf-8-sig").splitlines()
    except OSError as error:
        raise Refused(f"{path}: {error.strerror or error}") from None
    except UnicodeDecodeError as error:
        raise Refused(f"{path}: must be a CSV file in UTF-8, got {error}") from None
    numbered = [(k, line) for k, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith("#")]
    if not numbered:
        raise Refused(f"{path}: must have a line that names the columns, got no line")
    delimiter = next((one for one in "\t;" if one in numbered[0][1]), ",")
    cells = [(k, _cells(f"{path}, line {k}", line, delimiter)) for k, line in numbered]
    (first, names), rows = cells[0], cells[1:]
    for k, row in rows:
        if any(cell.strip() for cell in row[len(names) :]):
            commas = "; decimal commas need tabs or semicolons between cells" if delimiter == "," else ""
            raise Refused(f"{path}, line {k}: must have {len(names)} cells, as many as names, got {len(row)}{commas}")
    return CsvTable(Path(path), first, names, rows, delimiter != ",")


def _cells(where: str, line: str, delimiter: str) -> list[str]:
    """The cells of a line."""
    try:
        return next(csv.reader([line], delimiter=delimiter))
    except csv.Error as error:
        raise Refused(f"{where}: must be cells of CSV, got {error}") from None


def heading(cell: str) -> Heading:
    """The name and the unit, in brackets or parentheses, of a cell of the first line."""
    parts = re.fullmatch(r"\s*(.*?)\s*[\[(]\s*([^])]*?)\s*[\])]\s*", cell)
    return Heading(cell.strip(), "") if parts is None else Heading(parts[1], parts[2])


def factor(where: str, column: Heading, units: Mapping[str, float]) -> float:
    """Factor from a column's unit to SI units.

    Raises:
        Refused: no unit, or one that is not of such a quantity.
    """
    if column.unit not in units:
        raise Refused(f"{where}: {column.text} must name its unit in brackets, one of {', '.join(units)}")
    return units[column.unit]
