"""Ctrl-C: one line that says what is kept and how to go on, and exit code 130."""

import atexit
import os
import signal
from types import FrameType

INTERRUPTED = 128 + signal.SIGINT
NOTHING_KEPT = "stopped by Ctrl-C; nothing was written, the same command begins again"


class Interruption(SystemExit):
    """Ends the process with exit code 130; Python and Click say nothing of it."""


def first_rank() -> bool:
    """True for the first process of an MPI job, which reports for all, and without mpirun."""
    return os.environ.get("OMPI_COMM_WORLD_RANK", os.environ.get("PMIX_RANK", "0")) == "0"


def interruptible(line: str = NOTHING_KEPT) -> None:
    """Sets Ctrl-C to leave all contexts, as an exception does, to end the process and to print a line.

    Click would make "Aborted!" and exit code 1 of Python's own KeyboardInterrupt, and Python a traceback while it is
    still importing; so a command calls this before it imports what takes long, and again where something is kept.
    """

    def stop(_: int, frame: FrameType | None) -> None:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # a second one shall not disturb the end
        if _importing(frame):
            if first_rank():
                _say(line)
            os._exit(INTERRUPTED)  # an exception would be lost where a module tries whether another is there
        if first_rank():
            atexit.register(_say, line)  # after all that contexts still say, such as a bar
        raise Interruption(INTERRUPTED)

    signal.signal(signal.SIGINT, stop)


def _importing(frame: FrameType | None) -> bool:
    """True if this frame runs, directly or not, because a module is being imported."""
    while frame is not None:
        if frame.f_code.co_filename == "<frozen importlib._bootstrap>":
            return True
        frame = frame.f_back
    return False


def _say(line: str) -> None:
    from rom.console.terminal import say  # not before: until this module is imported, Ctrl-C is Python's

    say(line)
