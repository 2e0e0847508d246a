"""What the command lines of rom and control share: exit codes, JSON, one line for bad input."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Annotated, Any

import typer

from rom.terminal import say

BAD_INPUT, NOTHING_USABLE = 2, 3
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object on stdout.")]


def application() -> typer.Typer:
    """A command line without decoration."""
    return typer.Typer(
        add_completion=False, no_args_is_help=True, rich_markup_mode=None, pretty_exceptions_enable=False
    )


def show(result: dict[str, Any], as_json: bool, code: int = 0) -> None:
    """Print as JSON (strict: nan and inf become null), indented for people, and exit with a code."""
    print(json.dumps(_strict(result)) if as_json else json.dumps(_strict(result), indent=2))
    raise SystemExit(code)


def _strict(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _strict(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_strict(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def run(app: Callable[[], None]) -> None:
    """Run a command line; bad input is one line on stderr and exit code 2."""
    try:
        app()
    except (ValueError, OSError) as error:
        say(str(error))
        raise SystemExit(BAD_INPUT) from None
