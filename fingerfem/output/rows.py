"""Results as rows for people, which fit the window; JSON has all digits."""

import shutil
import sys
import textwrap
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NoReturn

from rom.console.table import Table, show

NAME = 24  # columns of a name


def finish(
    result: dict[str, Any], as_json: bool, code: int = 0, rank: int = 0, parts: Iterable[Table | str] | None = None
) -> NoReturn:
    """Print what a command found, on one rank: as JSON, as tables or as rows; and end with an exit code."""
    if rank != 0:
        raise SystemExit(code)
    if parts is None:
        parts = ["\n".join(rows(result))]
    show(result, parts, as_json, code)


def rows(result: dict[str, Any], indent: str = "") -> Iterator[str]:
    """A row for every value; on a terminal long ones go on below themselves."""
    for name, value in result.items():
        if isinstance(value, dict) and any(isinstance(one, dict | list) for one in value.values()):
            yield f"{indent}{name}"
            yield from rows(value, indent + "  ")
        else:
            yield _row(f"{indent}{name:{NAME - len(indent)}s} ", words(value))


def words(value: Any) -> str:
    """A value with six digits at most, a list without its brackets, a table as NAME=VALUE."""
    if isinstance(value, dict):
        return " ".join(f"{name}={words(one)}" for name, one in value.items()) or "none"
    if isinstance(value, list | tuple):
        return " ".join(words(one) for one in value)
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _row(name: str, value: str) -> str:
    if not sys.stdout.isatty():
        return name + value
    width = shutil.get_terminal_size().columns
    return textwrap.fill(value, max(width, 2 * NAME), initial_indent=name, subsequent_indent=" " * len(name)) or name


def check_ending(name: str, file: Path | None, ending: str) -> None:
    """Refuse the file of an option that cannot be of another format."""
    if file is not None and file.suffix.lower() != ending:
        raise ValueError(f"{name} must end in {ending}, got {file}")
