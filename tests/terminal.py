"""A person at a terminal, for tests: a command on a pseudo-terminal of 80 columns, what it shows, and Ctrl-C.

And a command without a terminal.
"""

import fcntl
import os
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import termios
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LINES, COLUMNS = 24, 80
PATIENCE = 600.0  # [s] after which a command counts as hanging; tests assert no other time
CONTROL = re.compile(r"\x1b\[[0-9;?]*[ -/]*[@-~]|\x1b\][^\x07]*\x07|\x1b[@-_]")
BAR = "━"
NOISE = ("Traceback", "No such option", "Aborted!", "Usage:", "KeyboardInterrupt", "Exception ignored")


def ran(program: str, *words: object) -> subprocess.CompletedProcess[str]:
    """`python3 -m PROGRAM WORDS` in the checkout, without a terminal."""
    command = [sys.executable, "-m", program, *map(str, words)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True)


@dataclass(frozen=True, kw_only=True)
class Shown:
    """Output of a command on a terminal, and its exit code.

    Attributes:
        code: its exit code; minus the signal's number if one ended it.
        raw: all that it wrote, control sequences included.
    """

    code: int
    raw: str

    @property
    def text(self) -> str:
        """Without control sequences; what is written over in place stands line under line."""
        return _plain(self.raw.encode())

    @property
    def lines(self) -> list[str]:
        """The lines of the text that are not empty."""
        return [line for line in self.text.splitlines() if line.strip()]

    @property
    def after_interrupt(self) -> list[str]:
        """The lines shown from Ctrl-C on, without bars."""
        return [line for line in self.text.rpartition("^C")[2].splitlines() if line.strip() and BAR not in line]

    @property
    def bars(self) -> set[str]:
        """The different lines with a bar that were shown."""
        return {line for line in self.lines if BAR in line}

    @property
    def coloured(self) -> bool:
        """True if anything has a colour."""
        return re.search(r"\x1b\[(3[0-9]|9[0-7])[;m]", self.raw) is not None

    def assert_readable(self) -> None:
        """No noise, no line that does not fit."""
        for word in NOISE:
            assert word not in self.text, self.text
        assert not [line for line in self.lines if len(line) > COLUMNS], self.text

    def assert_interrupted(self, line: str, code: int = 130) -> None:
        """It ended with this line, about all there is, and this exit code."""
        self.assert_readable()
        assert self.code == code, self.text
        assert [one.strip() for one in self.after_interrupt] == [line], self.text


def shown(
    command: list[str], interrupt_at: str | None = None, pause: float = 0.0, times: int = 1, **settings: str
) -> Shown:
    """Run a command on a terminal.

    Args:
        command: words.
        interrupt_at: where what is shown first matches this pattern, Ctrl-C is typed, which interrupts all processes of
            the foreground.
        pause: before it is typed [s].
        times: how often, at once.
        settings: further environment variables.
    """
    child, terminal = pty.fork()
    if child == 0:
        fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", LINES, COLUMNS, 0, 0))
        os.chdir(ROOT)
        kept = {name: value for name, value in os.environ.items() if name not in ("COLUMNS", "LINES", "NO_COLOR")}
        os.execvpe(command[0], command, kept | {"TERM": "xterm-256color"} | settings)
    written, deadline = b"", time.monotonic() + PATIENCE
    waiting = interrupt_at is not None
    try:
        while (piece := _read(terminal, deadline)) is not None:
            written += piece
            if waiting and re.search(str(interrupt_at), _plain(written)):
                time.sleep(pause)
                os.write(terminal, b"\x03" * times)
                waiting = False
    except TimeoutError:
        os.kill(child, signal.SIGKILL)
        raise AssertionError(f"{command} hangs after {_plain(written)[-3000:]}") from None
    finally:
        status = os.waitpid(child, 0)[1]
        os.close(terminal)
    assert not waiting, f"{interrupt_at!r} was never shown: {_plain(written)[-3000:]}"
    return Shown(code=os.waitstatus_to_exitcode(status), raw=written.decode(errors="replace"))


def _plain(written: bytes) -> str:
    return CONTROL.sub("", written.decode(errors="replace")).replace("\r", "\n")


def _read(terminal: int, deadline: float) -> bytes | None:
    """Reads the next bytes; None at the end."""
    while True:
        if time.monotonic() > deadline:
            raise TimeoutError
        if select.select([terminal], [], [], 1.0)[0]:
            try:
                return os.read(terminal, 65536) or None
            except OSError:  # Linux: nobody has the terminal open any more
                return None
