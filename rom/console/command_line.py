"""Shared code of rom's and control's command lines: one line for bad input, and what `rom check` found."""

from collections.abc import Callable
from typing import Annotated

import typer

from rom.console.program import NOTHING_USABLE as NOTHING_USABLE
from rom.console.program import one_line
from rom.console.table import Table, accuracy

AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object on stdout.")]


def application() -> typer.Typer:
    """A command line without decoration."""
    return typer.Typer(
        add_completion=False, no_args_is_help=True, rich_markup_mode=None, pretty_exceptions_enable=False
    )


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


def run(app: Callable[[], None]) -> None:
    """Run a command line; bad input is one line on stderr and exit code 2."""
    with one_line():
        app()
