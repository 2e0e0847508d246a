"""Ctrl-C: one line that says what is kept and how to go on, and exit code 130."""

from __future__ import annotations

import atexit
import os
import signal
from types import FrameType
from typing import NoReturn

from rom.terminal import say

INTERRUPTED = 128 + signal.SIGINT
NOTHING_KEPT = "stopped by Ctrl-C; nothing was written, the same command begins again"


def first_rank() -> bool:
    """Whether this process is the one of its MPI job that speaks for all, or not under mpirun at all."""
    return os.environ.get("OMPI_COMM_WORLD_RANK", os.environ.get("PMIX_RANK", "0")) == "0"


def interruptible(line: str = NOTHING_KEPT) -> None:
    """From here on Ctrl-C leaves all contexts, as an exception does, ends the process and says this line.

    Click would make "Aborted!" and exit code 1 of Python's own KeyboardInterrupt, and Python a traceback while it is
    still importing; so a command calls this before it imports what takes long, and again where something is kept.
    """

    def stop(_number: int, _frame: FrameType | None) -> NoReturn:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # a second one shall not disturb the end
        if first_rank():
            atexit.register(say, line)  # after all that contexts still say, such as a bar
        raise SystemExit(INTERRUPTED)

    signal.signal(signal.SIGINT, stop)
