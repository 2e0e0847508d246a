"""FFCx's cache of compiled forms, shared by the ranks of a job."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from mpi4py import MPI

T = TypeVar("T")
SECONDS_A_COMPILATION_MAY_TAKE = 300


def cache_folder() -> Path:
    """Where DOLFINx keeps compiled forms."""
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "fenics"


def clear_stale() -> list[Path]:
    """Remove sources whose compilation was killed: every later run would wait for them and fail."""
    stale = [
        source
        for source in cache_folder().glob("*.c")
        if not source.with_suffix(".c.cached").exists()
        and time.time() - source.stat().st_mtime > SECONDS_A_COMPILATION_MAY_TAKE
    ]
    for source in stale:
        source.unlink(missing_ok=True)
    return stale


def one_rank_first(comm: MPI.Comm, build: Callable[[], T]) -> T:
    """Call `build` on rank 0, then on the others, so that forms are compiled once (collective)."""
    if comm.rank == 0:
        clear_stale()
        built = build()
    comm.barrier()
    return built if comm.rank == 0 else build()
