"""FFCx's cache of compiled forms, shared by all processes of a machine."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

T = TypeVar("T")


def cache_folder() -> Path:
    """Where DOLFINx keeps compiled forms."""
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "fenics"


def one_at_a_time(build: Callable[[], T]) -> T:
    """Call what compiles forms while no other process does, so that every form is compiled once.

    A lock, not a barrier: a process that is killed while it compiles frees it, and what it left half done, for which
    FFCx would wait in vain, is cleared by the next.
    """
    folder = cache_folder()
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "compiling", "a+b") as turn:
        fcntl.lockf(turn, fcntl.LOCK_EX)
        for source in folder.glob("*.c"):
            if not source.with_suffix(".c.cached").exists():
                source.unlink(missing_ok=True)
        return build()
