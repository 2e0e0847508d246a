"""Shared code of rom's and control's command lines: exit codes, JSON, one line for bad input."""

import json
import math
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer

from rom.console.program import NOTHING_USABLE as NOTHING_USABLE
from rom.console.program import one_line
from rom.console.table import Table, accuracy, print_tables

AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object on stdout.")]


def application() -> typer.Typer:
    """A command line without decoration."""
    return typer.Typer(
        add_completion=False, no_args_is_help=True, rich_markup_mode=None, pretty_exceptions_enable=False
    )


def show(result: dict[str, Any], parts: Iterable[Table | str], as_json: bool, code: int = 0) -> NoReturn:
    """Print as tables and lines for people or as JSON (strict: nan and inf become null), and exit with a code."""
    if as_json:
        print(json.dumps(_strict(result)))
    else:
        print_tables(parts)
    raise SystemExit(code)


def check_parts(report: dict) -> list[Table | str]:
    """Lines and tables with the results of `rom check`."""
    lines: list[Table | str] = []
    if "states" in report:
        kind = "training" if report.get("training") else "held-out"
        lines = [f"{report['states']} {kind} states, {report['failed']} failed", *accuracy(report)]
    if report.get("marked"):
        lines.append(f"{report['marked']} states are outside the model's domain: marked, not counted")
    if "covered" in report:
        lines.append(f"{report['covered']:.0%} of the contact forces are within the estimate")
    if "touch" in report:
        touch = report["touch"]
        decided = f"touch is decided correctly in {touch['count'] - touch['wrong']} of {touch['count']} states"
        if touch["wrong"]:
            far = f"{touch['wrong_beyond_margin']} of {touch['wrong']}"
            decided += f"; {far} wrong ones are farther than {1e6 * touch['margin']:g} µm from touch"
        lines.append(decided)
    return lines


def _strict(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _strict(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_strict(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def run(app: Callable[[], None]) -> None:
    """Run a command line; bad input is one line on stderr and exit code 2."""
    with one_line():
        app()


def check_folder(file: Path, option: str = "output") -> None:
    """Refuse a file that could not be written, before there is anything to write."""
    if not file.parent.is_dir():
        raise ValueError(f"{option} must be in a folder that exists, got {file}")


def check_plot(file: Path) -> None:
    """Refuse a picture that could not be written, for its folder or for its format, which the file's ending names."""
    from matplotlib.figure import Figure

    formats = Figure().canvas.get_supported_filetypes()
    if file.suffix.removeprefix(".") not in formats:
        raise ValueError(f"plot must end in one of {', '.join(sorted(formats))}, got {file}")
    check_folder(file, "plot")
