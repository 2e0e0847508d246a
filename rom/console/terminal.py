"""Output while a command works: lines that fit the window, and a bar on a terminal, or lines in a pipe."""

import codecs
import logging
import shutil
import sys
import textwrap
import time
import unicodedata
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from importlib.util import find_spec
from typing import Protocol, TextIO

EVERY = 10.0  # [s] between two lines of progress where there is no bar
PLAIN = "fingerfem.plain"  # name of the error handler of `codecs`
# Substitutes for characters that the encoding of an output does not have.
SUBSTITUTES = {"µ": "u", "±": "+-"}


class Progress(Protocol):
    """Receives how far a step is; long functions take one."""

    def __call__(self, step: str, done: int, total: int) -> None:
        """Reports that `done` parts of `total` of a step are done; a total of 0 is undetermined."""


def quiet(step: str, done: int, total: int) -> None:
    """Says nothing."""


def say(line: str, terminal: bool = False) -> None:
    """One line on stderr, on a terminal broken between words to fit the window, and over the ^C that is shown there.

    Args:
        line: to be said.
        terminal: on the terminal that the process belongs to, if it has one, wherever stderr leads.
    """
    own = own_terminal() if terminal and not sys.stderr.isatty() else None
    with own or nullcontext(sys.stderr) as stream:
        print(f"\r{fitted(line)}" if stream.isatty() else line, file=stream, flush=True)


def own_terminal() -> TextIO | None:
    """The terminal that the process belongs to, if any: mpirun passes on whole lines only, and at its end nothing."""
    try:
        return open("/dev/tty", "w", encoding=sys.stderr.encoding, errors=sys.stderr.errors)
    except OSError:
        return None


def printable(text: str, stream: TextIO) -> str:
    """A text in characters that a stream's encoding has."""
    encoding = stream.encoding or "utf-8"
    return text.encode(encoding, PLAIN).decode(encoding)


def _plain(error: UnicodeError) -> tuple[str, int]:
    """An error handler of `codecs`: characters that the encoding has, for those that it does not have."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(map(_substitute, error.object[error.start : error.end])), error.end


codecs.register_error(PLAIN, _plain)


def _substitute(character: str) -> str:
    """ASCII substitute of a character: itself without accents, or a question mark."""
    plain = unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode()
    return SUBSTITUTES.get(character) or plain or "?"


def fitted(text: str) -> str:
    """A text broken between words so that it fits the window."""
    width = shutil.get_terminal_size().columns
    return "\n".join(
        textwrap.fill(line, width, break_long_words=False, break_on_hyphens=False) for line in text.splitlines()
    )


class Lines(logging.StreamHandler):
    """Log lines that fit the window, above a bar if there is one: that is what sys.stderr is while it is drawn."""

    def __init__(self) -> None:
        logging.Handler.__init__(self)

    @property
    def stream(self) -> TextIO:
        """Current standard error stream, which lines are written to."""
        return sys.stderr

    def format(self, record: logging.LogRecord) -> str:
        """The line, without decoration."""
        return fitted(super().format(record)) if self.stream.isatty() else super().format(record)


def log_lines(level: int = logging.INFO) -> None:
    """Log to stderr, as lines for people."""
    logging.basicConfig(format="%(message)s", level=level, handlers=[Lines()])


@contextmanager
def steps() -> Iterator[Progress]:
    """Show the steps of a long job: a bar each on a terminal, if rich is there, else a line every ten seconds."""
    if not sys.stderr.isatty() or find_spec("rich") is None:
        yield _Now()
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Task, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bars
    from rich.text import Text

    class Count(MofNCompleteColumn):
        def render(self, task: Task) -> Text:
            return super().render(task) if task.total else Text(str(int(task.completed)))

    columns = TextColumn("{task.description}"), BarColumn(20), Count(), TimeElapsedColumn()
    with Bars(*columns, console=Console(stderr=True)) as bars:
        tasks = {}

        def show(step: str, done: int, total: int) -> None:
            if step not in tasks:
                tasks[step] = bars.add_task(step, total=total or None)
            bars.update(tasks[step], completed=done, total=total or None)

        yield show


class _Now:
    """A line now and then."""

    def __init__(self) -> None:
        self._last = time.monotonic()

    def __call__(self, step: str, done: int, total: int) -> None:
        now = time.monotonic()
        if now - self._last >= EVERY:
            self._last = now
            print(f"{step}: {done}" + (f" of {total}" if total else ""), file=sys.stderr, flush=True)
