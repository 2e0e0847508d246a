"""Begin and end of a command: Ctrl-C, bad input, a warning and a missing package are one line each.

Output fits its encoding.

Only the standard library is imported here, as a command calls `begin` before it imports anything else.
"""

import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Any, NoReturn

from rom.console.interruption import first_rank, interruptible
from rom.console.packages import explained
from rom.console.terminal import PLAIN, say

BAD_INPUT, NOTHING_USABLE = 2, 3


def begin() -> None:
    """Sets Ctrl-C and failing imports to end the process in one line, and its output to accept all characters."""
    interruptible()  # what comes next may take seconds to import
    sys.excepthook = _explain
    warnings.showwarning = _warn
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors=PLAIN)


@contextmanager
def one_line(*unusable: type[Exception]) -> Iterator[None]:
    """Ends the process in one line for bad input, exit code 2; or for one of these exceptions, exit code 3.

    A signal that ends the process keeps its exit code, whatever fails while contexts are left, such as a half-written
    archive that cannot be closed.
    """
    try:
        yield
    except ImportError as error:
        reason = explained(error)
        if reason is None:
            raise
        _end(reason, BAD_INPUT)
    except unusable as error:
        _end(str(error), _code_of_ending(error.__context__) or NOTHING_USABLE)
    except (ValueError, OSError) as error:
        _end(str(error), _code_of_ending(error.__context__) or BAD_INPUT)


def _code_of_ending(error: BaseException | None) -> int | None:
    """The exit code with which the process was about to end when an error was raised."""
    while error is not None:
        if isinstance(error, SystemExit) and isinstance(error.code, int):
            return error.code
        error = error.__context__
    return None


def _end(reason: str, code: int) -> NoReturn:
    if first_rank():  # all ranks of a job stop for the same reason
        say(reason)
    raise SystemExit(code) from None


def _explain(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    """Reports an uncaught exception; that of a missing package as one line. Installed as `sys.excepthook`."""
    reason = explained(error) if isinstance(error, ImportError) else None
    if reason is None:
        sys.__excepthook__(kind, error, trace)
    else:
        _end(reason, BAD_INPUT)


def _warn(message: Warning | str, category: type[Warning], *_: Any, **__: Any) -> None:
    """Prints a warning as one line, on the first rank. Installed as `warnings.showwarning`."""
    if first_rank():
        say(str(message) if category is UserWarning else f"{category.__name__}: {message}")
