"""FFCx's cache of compiled forms, shared by all processes of a machine."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from mpi4py import MPI

T = TypeVar("T")


def cache_folder() -> Path:
    """Where DOLFINx keeps compiled forms."""
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "fenics"


def once(build: Callable[[], T], key: str, comm: MPI.Comm = MPI.COMM_SELF) -> T:
    """Call what compiles forms so that every form is compiled once, by one group of ranks.

    The first to come compiles under a lock; once all that `key` names is compiled, the others load it at once. A lock,
    not a barrier: a process that is killed while it compiles frees it, and what it left half done, for which FFCx would
    wait in vain, is cleared by the next.
    """
    if comm.rank != 0:
        return build()
    folder = cache_folder()
    folder.mkdir(parents=True, exist_ok=True)
    whole = folder / f"{key}.whole"
    if whole.exists() and not _half_done(folder):
        return build()
    with open(folder / "compiling", "a+b") as turn:
        fcntl.lockf(turn, fcntl.LOCK_EX)
        for source in _half_done(folder):
            source.unlink(missing_ok=True)
        built = build()
        whole.touch()
        return built


def _half_done(folder: Path) -> list[Path]:
    """Sources that a process which compiles them now, or was killed, has left."""
    return [source for source in folder.glob("*.c") if not source.with_suffix(".c.cached").exists()]
