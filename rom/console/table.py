"""Tables for people: columns in a pipe, rich's on a terminal, HTML in a notebook; and numbers with their units."""

from __future__ import annotations

import html
import json
import math
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any, NoReturn, TextIO

import numpy as np

from rom.brief import brief
from rom.console.terminal import fitted, printable
from rom.parameter import Parameter

SHOWN = {"m": (1e3, "mm"), "Pa": (1e-3, "kPa"), "m^3": (1e9, "mm^3")}  # see `shown`
ABSOLUTE = {
    "_m": (1e6, "µm"),
    "_m3": (1e9, "mm^3"),
    "_rad": (1e3, "mrad"),
}  # of errors that are not relative, by the end of their name
ZERO = 1e-10  # of what is shown: below that a value is round-off
NO_ERROR = ""
NOT_MEASURED = "accuracy not measured: build with --held-out"
COVERED = "± error"  # column of estimated errors, which cover 95 of 100 states


@brief
@dataclass(frozen=True, kw_only=True)
class Table:
    """Rows of words under a header.

    Attributes:
        header: of the columns.
        rows: as long as the header.
        title: above it; may be empty.

    Example:
        >>> print(Table(header=["tendon", "[N]"], rows=[["F1", "20"]]).text)
    """

    header: Sequence[str]
    rows: Sequence[Sequence[str]]
    title: str = ""

    @property
    def text(self) -> str:
        """Text in columns: cells of the first are aligned left, others right."""
        whole = [self.header, *self.rows]
        widths = [max(map(len, column)) for column in zip(*whole, strict=True)]
        lines = [
            "   ".join([row[0].ljust(widths[0]), *(cell.rjust(w) for cell, w in zip(row[1:], widths[1:], strict=True))])
            for row in whole
        ]
        return "\n".join([*([self.title] if self.title else []), *(line.rstrip() for line in lines)])

    def printed(self, stream: TextIO) -> Table:
        """The same in characters that a stream's encoding has."""
        return Table(
            header=[printable(cell, stream) for cell in self.header],
            rows=[[printable(cell, stream) for cell in row] for row in self.rows],
            title=printable(self.title, stream),
        )

    @property
    def html(self) -> str:
        """HTML for a notebook."""
        head = "".join(f"<th>{html.escape(cell)}</th>" for cell in self.header)
        body = "".join(f"<tr>{''.join(f'<td>{html.escape(cell)}</td>' for cell in row)}</tr>" for row in self.rows)
        title = f"<caption>{html.escape(self.title)}</caption>" if self.title else ""
        return f"<table>{title}<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def as_html(parts: Iterable[Table | str]) -> str:
    """Tables and lines between them, for a notebook."""
    return "".join(part.html if isinstance(part, Table) else f"<p>{html.escape(part)}</p>" for part in parts)


def print_tables(parts: Iterable[Table | str]) -> None:
    """Tables and lines between them, on stdout, in characters that its encoding has."""
    parts = [part.printed(sys.stdout) if isinstance(part, Table) else printable(part, sys.stdout) for part in parts]
    if sys.stdout.isatty() and find_spec("rich") is not None:
        _print_rich(parts)
        return
    text = "\n".join(part.text if isinstance(part, Table) else part for part in parts)
    print(fitted(text) if sys.stdout.isatty() else text)


def _print_rich(parts: Iterable[Table | str]) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table as Rich

    console = Console(highlight=False)
    for part in parts:
        if isinstance(part, str):
            console.print(part, markup=False)
            continue
        drawn = Rich(
            title=part.title or None, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False
        )
        for k, name in enumerate(part.header):
            drawn.add_column(name.replace("[", r"\["), justify="right" if k else "left", overflow="fold")
        for row in part.rows:
            drawn.add_row(*(cell.replace("[", r"\[") for cell in row))
        console.print(drawn)


def show(result: dict[str, Any], parts: Iterable[Table | str], as_json: bool, code: int = 0) -> NoReturn:
    """Print as tables and lines for people or as JSON (strict: nan and inf become null), and exit with a code."""
    if as_json:
        print(json.dumps(_strict(result)))
    else:
        print_tables(parts)
    raise SystemExit(code)


def _strict(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _strict(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_strict(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def percent(share: float) -> str:
    """A share: 0.01234 is 1.2 %; below 1 it is never 100 %."""
    return f"{100 * share:.2g} %" if share < 0.99 or share > 1 else f"{math.floor(1e3 * share + 1e-9) / 10:g} %"


def millimetres(values: Iterable[float]) -> str:
    """A point [m] in millimetres."""
    return f"({', '.join(f'{1e3 * value:.3f}' for value in values)}) mm"


def shown(unit: str) -> tuple[float, str]:
    """Factor from an SI unit to the unit that tables show, and that unit."""
    return SHOWN.get(unit, (1.0, unit))


def number(value: float, unit: str, digits: int = 4) -> str:
    """A value in the unit that people read, without that; what is not known is a dash."""
    read = float(value) * shown(unit)[0]
    if math.isnan(read):
        return "-"
    return "0" if abs(read) < ZERO else f"{read:.{digits}g}"


def row(name: str, value: float, unit: str, error: float | None = None) -> list[str]:
    """A quantity: name, value, estimated error and the unit that people read."""
    estimate = NO_ERROR if error is None else number(error, unit, 2)
    return [name, number(value, unit), estimate, shown(unit)[1]]


def quantities(rows: Sequence[Sequence[str]], title: str = "") -> Table:
    """Quantities by `row`; the column of errors is left out where there are none."""
    if any(one[2] for one in rows):
        return Table(title=title, header=["quantity", "value", COVERED, "unit"], rows=rows)
    return Table(title=title, header=["quantity", "value", "unit"], rows=[[one[0], one[1], one[3]] for one in rows])


def components(
    name: str, values: Sequence[float] | np.ndarray, unit: str, error: float | None = None
) -> list[list[str]]:
    """The rows of a vector: x, y and z; the error is of its length."""
    return [row(f"{name} {axis}", value, unit, error) for axis, value in zip("xyz", values, strict=True)]


def parameters(those: Sequence[Parameter], title: str = "") -> Table:
    """Parameters and where they were trained."""
    rows = []
    for one in those:
        ends = [number(end, one.unit) for end in (one.lower, one.upper)]
        rows.append([one.name, *ends, shown(one.unit)[1]])
    return Table(title=title, header=["parameter", "from", "to", "unit"], rows=rows)


def accuracy(report: Mapping[str, Any]) -> list[Table]:
    """Errors in a report of `rom check`, or a model's own; nothing if there are none."""
    known = {name: one for name, one in report.items() if isinstance(one, dict) and "median" in one}
    rows = []
    for name, one in known.items():
        unit = next((end for end in ABSOLUTE if name.endswith(end)), "")
        factor, read = ABSOLUTE.get(unit, (1.0, ""))
        errors = (f"{factor * one[key]:.3g} {read}" if unit else percent(one[key]) for key in ("median", "p95", "max"))
        covered = percent(one["coverage"]) if "coverage" in one else ""
        rows.append([name.removesuffix(unit).replace("_", " "), str(one["count"]), *errors, covered])
    header = ["relative error", "states", "median", "95 %", "largest", "within estimate"]
    return [Table(header=header, rows=rows)] if rows else []
