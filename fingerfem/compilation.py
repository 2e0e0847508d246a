"""Compiled forms in a cache of the project's own, shared by all processes of a machine."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from dolfinx import fem
from mpi4py import MPI

from fingerfem.scene import Scene
from fingerfem.versions import versions


def cache_folder() -> Path:
    """Where compiled forms are kept; nobody else's are."""
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "fingerfem" / "forms"


def form(integrals: Any) -> fem.Form:
    """A compiled form that DOLFINx 0.9 assembles whole: one integral a region."""
    made = fem.form(integrals, jit_options={"cache_dir": cache_folder()})
    for kind in (fem.IntegralType.cell, fem.IntegralType.exterior_facet):
        regions = list(made._cpp_object.integral_ids(kind))
        if len(set(regions)) < len(regions):
            raise AssertionError(f"a form has two integrals over one of the regions {regions}")
    return made


def expression(value: Any, points: np.ndarray) -> fem.Expression:
    """An expression compiled for points of the reference cell, shape (n, 3)."""
    return fem.Expression(value, points, jit_options={"cache_dir": cache_folder()})


@contextmanager
def turn(scene: Scene, what: str, comm: MPI.Comm) -> Iterator[None]:
    """Where a group of ranks compiles `what` a scene needs, so that every form is compiled once by one of many groups.

    The first to come compiles under a lock; once all is compiled, the others load it at once. A lock, not a barrier: a
    process that is killed while it compiles frees it, and what it left half done, for which FFCx would wait in vain, is
    cleared by the next.
    """
    if comm.rank != 0:
        yield
        return
    folder = cache_folder()
    folder.mkdir(parents=True, exist_ok=True)
    whole = folder / "-".join([scene.fingerprint(), *versions().values(), what])
    if whole.exists() and not _half_done(folder):
        yield
        return
    with open(folder / "compiling", "a+b") as lock:
        fcntl.lockf(lock, fcntl.LOCK_EX)
        for file in _half_done(folder):
            file.unlink(missing_ok=True)
        yield
        whole.touch()


def _half_done(folder: Path) -> list[Path]:
    """Sources and marks without each other, which a process that compiles now, or was killed, has left."""
    sources = {file.stem: file for file in folder.glob("*.c")}
    marks = {file.name.removesuffix(".c.cached"): file for file in folder.glob("*.c.cached")}
    return [(sources | marks)[name] for name in sources.keys() ^ marks.keys()]
