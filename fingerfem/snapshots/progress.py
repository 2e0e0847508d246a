"""Progress of a set: a bar on a terminal, else plain lines or JSON lines; always a log in the set's folder.

A bar that is asked for under mpirun is drawn on the terminal itself: Open MPI passes on whole lines only, and a bar is
none before its end.
"""

import json
import os
import sys
import time
from datetime import datetime
from typing import IO, Self

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from fingerfem.snapshots.ledger import Ledger
from rom.console.terminal import own_terminal

EVERY = {"bar": 0.5, "plain": 30.0, "json": 1.0}  # [s]
STYLES = ("auto", *EVERY)


class Reporter:
    """Says how many lines of states are solved, how fast, how long it will take, what failed; a context, and a call."""

    def __init__(self, ledger: Ledger, style: str = "auto"):
        self._ledger, self._begun, self._last = ledger, time.monotonic(), -1e9
        self._terminal = own_terminal() if style == "bar" and not sys.stderr.isatty() else None
        console = Console(stderr=True)
        if self._terminal is not None:
            console = Console(file=self._terminal, width=os.get_terminal_size(self._terminal.fileno()).columns)
        shown = "bar" if console.is_terminal else "plain"
        self._style = shown if style in ("auto", "bar") else style
        self._console = console
        self._log: IO[str] | None = None
        # 80 columns are 6 + 1 + 12 + 1 + 9 + 1 + 7 + 1 and 42 of a note, of long sets a little less.
        columns = TextColumn("lines"), BarColumn(12), MofNCompleteColumn(), TimeRemainingColumn()
        self._bar = Progress(*columns, TextColumn("{task.fields[note]}"), console=console)
        self._line = self._bar.add_task("", total=len(ledger.plan.lines), note="")
        self._at_start: tuple[int, int] | None = None

    def __enter__(self) -> Self:
        if self._style == "bar":
            self._bar.start()
        return self

    def __exit__(self, *_) -> None:
        self._last = -1e9
        if self._ledger.path.exists():
            self()
        self._bar.stop()
        if self._terminal is not None:
            self._terminal.close()
        if self._log is not None:
            self._log.close()

    def __call__(self) -> None:
        """Look at the set and say what has changed, now and then."""
        now = time.monotonic()
        if now - self._last < EVERY[self._style]:
            return
        self._last = now
        self._ledger.refresh()
        row = self._row(now - self._begun)
        if self._log is None:
            self._log = (self._ledger.path / "progress.log").open("a", buffering=1)
        print(datetime.now().astimezone().isoformat(timespec="seconds"), _sentence(row), file=self._log)
        if self._style == "bar":
            self._bar.update(self._line, completed=row["done"], total=row["tasks"], note=_note(row))
        else:
            self._console.print(
                json.dumps(row) if self._style == "json" else _sentence(row), soft_wrap=True, highlight=False
            )

    def _row(self, elapsed: float) -> dict:
        ledger, done = self._ledger, len(self._ledger.outcomes)
        states, total = ledger.states, len(ledger.plan.lines)
        self._at_start = self._at_start or (done, states)
        solved = done - self._at_start[0]
        rounds = ledger.plan.rounds
        refined = (
            {"round": len(rounds), "estimated_error": rounds[-1].error} if ledger.description.refines and rounds else {}
        )
        return refined | {
            "done": done,
            "tasks": total,
            "states": states,
            "failed": len(ledger.failures),
            "rate": (states - self._at_start[1]) / elapsed if elapsed > 0 else 0.0,
            "remaining_seconds": elapsed / solved * (total - done) if solved else None,
        }


def _note(row: dict) -> str:
    """Text behind the bar: rate, failures and estimated error."""
    round_ = f", error {100 * row['estimated_error']:.2g} %" if "round" in row else ""
    return f"{row['rate']:.1f} states/s, {row['failed']} failed{round_}"


def _sentence(row: dict) -> str:
    left = row["remaining_seconds"]
    then = "" if left is None or row["done"] == row["tasks"] else f", {left / 60:.0f} min to go"
    round_ = f"; round {row['round']}, estimated error {100 * row['estimated_error']:.2g} %" if "round" in row else ""
    return (
        f"{row['done']} of {row['tasks']} lines, {row['states']} states ({row['failed']} failed), "
        f"{row['rate']:.2f} states/s{then}{round_}"
    )
