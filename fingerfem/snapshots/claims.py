"""Claims on the tasks of a set, without a master and without messages.

A claim only saves work: whoever solves a task writes the same numbers, whole, under the same name. So a claim that is
wrongly held or wrongly freed costs time and never a result, whatever a file system or a clock does.
"""

import contextlib
import fcntl
import logging
import os
import struct
import threading
import time
from pathlib import Path
from types import TracebackType
from typing import Protocol, Self

logger = logging.getLogger(__name__)


class Claims(Protocol):
    """Record of the processes that work on tasks; a context that gives back the claims still held."""

    def take(self, i: int) -> bool:
        """Claim task i; False if somebody else holds it."""
        ...

    def give_back(self, i: int) -> None:
        """Free task i."""
        ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


def open_claims(path: str | Path) -> Claims:
    """The claims of the set in a folder: locks where the file system has them, files where it has not."""
    reason = why_no_locks(Path(path))
    if reason is None:
        return Locks(path)
    logger.warning("%s: %s; tasks are claimed by files that their owners keep touching", path, reason)
    return ClaimFiles(path)


class Locks:
    """Task i is byte i of a file: an advisory lock, which the kernel frees when its process dies."""

    def __init__(self, path: str | Path):
        self._file = open(Path(path) / "claims", "a+b")  # noqa: SIM115 - open as long as claims are held

    def take(self, i: int) -> bool:
        """Claim task i; False if somebody else holds it."""
        try:
            fcntl.lockf(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, i)
        except (BlockingIOError, PermissionError):
            return False
        return True

    def give_back(self, i: int) -> None:
        """Free task i."""
        fcntl.lockf(self._file, fcntl.LOCK_UN, 1, i)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_) -> None:
        self._file.close()


class ClaimFiles:
    """Task i is a file, made by one process alone and touched by it as long as it lives.

    A claim is dead when its process is, which only the same machine can see, or when its file has not changed for
    `patience` seconds of the onlooker's own steady clock; clocks of two machines are never compared.
    """

    def __init__(self, path: str | Path, heartbeat: float = 5.0, patience: float = 120.0):
        self._folder, self._patience = Path(path) / "claimed", patience
        self._folder.mkdir(exist_ok=True)
        self._me = f"{_machine()} {os.getpid()} {_started(os.getpid())}"
        self._held: dict[int, int] = {}
        self._seen: dict[int, tuple[tuple, float]] = {}
        self._turn, self._over = threading.Lock(), threading.Event()
        self._thread = threading.Thread(target=self._touch, args=(heartbeat,), daemon=True)
        self._thread.start()

    def _file(self, i: int) -> Path:
        return self._folder / str(i)

    def _touch(self, heartbeat: float) -> None:
        beats = 0
        while not self._over.wait(heartbeat):
            beats += 1
            with self._turn, contextlib.suppress(OSError):  # a full disk must not end the heartbeat
                for handle in self._held.values():
                    os.pwrite(handle, f"{self._me} {beats}".encode(), 0)

    def take(self, i: int) -> bool:
        """Claim task i; False if somebody else holds it and lives."""
        try:
            handle = os.open(self._file(i), os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o644)
        except FileExistsError:
            if self._dead(i):
                self._file(i).unlink(missing_ok=True)  # whoever comes first has it
            return False
        with self._turn:
            self._held[i] = handle  # first: a claim that cannot be written, on a full disk, is given back at the end
        os.write(handle, self._me.encode())
        return True

    def _dead(self, i: int) -> bool:
        try:
            status, said = self._file(i).stat(), self._file(i).read_text()
        except OSError:
            return False  # given back
        owner = said.split()
        if len(owner) >= 3 and owner[0] == self._me.split()[0]:
            return _started(int(owner[1])) != owner[2]
        shape, now = (status.st_ino, status.st_mtime_ns, said), time.monotonic()
        if self._seen.get(i, (None, now))[0] != shape:
            self._seen[i] = shape, now
        return now - self._seen[i][1] > self._patience

    def give_back(self, i: int) -> None:
        """Free task i."""
        with self._turn:
            os.close(self._held.pop(i))
        self._file(i).unlink(missing_ok=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_) -> None:
        for i in list(self._held):
            self.give_back(i)
        self._over.set()
        self._thread.join()


def _machine() -> str:
    """Scope in which a process number is unique: this boot of this machine, in this container."""
    boot = Path("/proc/sys/kernel/random/boot_id").read_text().strip()
    return f"{boot}/{os.stat('/proc/self/ns/pid').st_ino}"


def _started(pid: int) -> str:
    """Start of a process [ticks since boot], empty if there is none: a system reuses the numbers of processes."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[19]
    except OSError:
        return ""


def why_no_locks(folder: Path) -> str | None:
    """Why locks in a folder cannot be relied on, None if they can."""
    kind, options = _mount(folder)
    local = {"nolock", "local_lock=all", "local_lock=posix", "localflock", "noflock"} & set(options)
    if local:
        return f"locks do not reach other machines on this {kind} file system ({', '.join(sorted(local))})"
    byte = 2**40 + os.getpid()
    try:
        with open(folder / "claims", "a+b") as mine, open(folder / "claims", "a+b") as other:
            fcntl.fcntl(mine, fcntl.F_OFD_SETLK, _exclusive(byte))
            try:
                fcntl.fcntl(other, fcntl.F_OFD_SETLK, _exclusive(byte))
            except (BlockingIOError, PermissionError):
                return None
            return f"locks on this {kind} file system keep nobody out"
    except OSError as error:
        return f"no locks on this {kind} file system ({error.strerror})"


def _exclusive(byte: int) -> bytes:
    """A struct flock for an exclusive lock on one byte."""
    return struct.pack("hhqqi4x", fcntl.F_WRLCK, os.SEEK_SET, byte, 1, 0)


def _mount(folder: Path) -> tuple[str, list[str]]:
    """Kind and options of the file system that holds a folder (Linux: proc(5), mountinfo)."""
    place, mount = folder.resolve(), ("unknown", [""])
    for line in Path("/proc/self/mountinfo").read_text().splitlines():
        before, _, after = line.partition(" - ")
        point, (kind, _, options) = Path(before.split()[4].replace("\\040", " ")), after.split(" ", 2)
        if place.is_relative_to(point):  # later lines cover earlier ones
            mount = kind, [*before.split()[5].split(","), *options.split(",")]
    return mount
