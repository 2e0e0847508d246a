"""What the command lines of rom and control share: exit codes, JSON, one line for bad input."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterable, Sequence
from typing import Annotated, Any

import typer

from rom.terminal import fitted, say

BAD_INPUT, NOTHING_USABLE = 2, 3
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object on stdout.")]


def application() -> typer.Typer:
    """A command line without decoration."""
    return typer.Typer(
        add_completion=False, no_args_is_help=True, rich_markup_mode=None, pretty_exceptions_enable=False
    )


def show(result: dict[str, Any], lines: Iterable[str], as_json: bool, code: int = 0) -> None:
    """Print as lines for people or as JSON (strict: nan and inf become null), and exit with a code."""
    text = json.dumps(_strict(result)) if as_json else "\n".join(lines)
    print(fitted(text) if sys.stdout.isatty() and not as_json else text)
    raise SystemExit(code)


def columns(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows of a table as lines: the first column begins where all do, the others end there."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "   ".join(
            [row[0].ljust(widths[0]), *(cell.rjust(w) for cell, w in zip(row[1:], widths[1:], strict=True))]
        ).rstrip()
        for row in rows
    ]


def percent(share: float) -> str:
    """A share: 0.01234 is 1.2 %; below 1 it is never 100 %."""
    return f"{100 * share:.2g} %" if share < 0.99 or share > 1 else f"{math.floor(1e3 * share + 1e-9) / 10:g} %"


def millimetres(values: Iterable[float]) -> str:
    """A point [m] in millimetres."""
    return f"({', '.join(f'{1e3 * value:.3f}' for value in values)}) mm"


def errors(report: dict[str, Any]) -> list[str]:
    """The errors in a report of `rom check`, or a model's own, as a table."""
    head = ["relative error", "states", "median", "95 %", "largest", "within estimate"]
    known = {name: one for name, one in report.items() if isinstance(one, dict) and "median" in one}
    rows = [
        [
            name.removesuffix("_m").replace("_", " ") + (" [um]" if name.endswith("_m") else ""),
            str(one["count"]),
            *(
                f"{1e6 * one[key]:.3g}" if name.endswith("_m") else percent(one[key])
                for key in ("median", "p95", "max")
            ),
            percent(one["coverage"]) if "coverage" in one else "",
        ]
        for name, one in known.items()
    ]
    return columns([head, *rows]) if rows else []


def check_lines(report: dict) -> list[str]:
    """What `rom check` found, for people."""
    lines = []
    if "states" in report:
        lines = [f"{report['states']} held-out states, {report['failed']} failed", *errors(report)]
    if report.get("calibration_states"):
        lines[0] += f"; {report['calibration_states']} others calibrated the model's estimated errors"
    if report.get("marked"):
        lines.append(f"{report['marked']} states are beyond what was trained, or rubber touches: marked, not counted")
    if "covered" in report:
        lines.append(f"{report['covered']:.0%} of the contact forces are within the estimate")
    if "touch" in report:
        touch = report["touch"]
        lines.append(f"touch is decided rightly in {touch['count'] - touch['wrong']} of {touch['count']} states")
        if touch["wrong"]:
            far = f"{touch['wrong_beyond_margin']} of {touch['wrong']}"
            lines[-1] += f"; {far} wrong ones are farther than {1e6 * touch['margin']:g} um from touch"
    if "chosen" in report:
        chosen = report["chosen"]
        got = f", got {chosen['got']:.2%}" if "got" in chosen else ""
        quantity = chosen["quantity"].replace("_", " ")
        lines.append(f"{chosen['asked']}: expected {chosen['error']:.2%} of {quantity} at the 95th percentile{got}")
    if "against" in report:
        mesh = report["against"]["mesh"]
        cells = " x ".join(map(str, mesh["cells"]))
        taught = ", which told the model what its mesh errs by" if report["against"]["taught"] else ""
        lines.append(f"against {cells} cells of order {mesh['order']}{taught}, mesh and surrogate together:")
        lines += check_lines(report["against"])
    return lines


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
