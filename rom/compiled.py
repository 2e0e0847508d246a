"""Compiled functions: numba's, kept on disk from run to run as long as no source changes that they may have in them."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from numba import njit


def compiled(function: Callable[..., Any] | None = None, *, allocates: bool = False, **options: Any) -> Any:
    """Compile a function at its first call, as numba.njit does with these options; division by zero gives inf or nan.

    Numba keeps compiled functions beside their source and drops them when that file changes. But a function contains
    those that it calls, from other modules too, whose layout of data may have changed with them. Here it is dropped
    when any source of its package or of this one changes.

    Args:
        function: what to compile.
        allocates: whether it makes arrays, or calls what does. All else is compiled without counting references to
            arrays, which for tuples of many arrays takes longer than the work itself; numba then refuses to allocate.
        options: of numba.njit.
    """
    if function is None:
        return lambda named: compiled(named, allocates=allocates, **options)
    options |= {"error_model": "numpy", "_nrt": allocates}
    try:
        made = njit(cache=True, **options)(function)
        file = made._cache._cache_file
        file._source_stamp = (*file._source_stamp, _sources(Path(function.__code__.co_filename).parent))
        file._load_index = _forgiving(file._load_index)
    except (AttributeError, OSError, RuntimeError):  # another numba, no place to keep it, no sources to go by: not kept
        made = njit(**options)(function)
    return made


def _forgiving(load: Callable[[], dict]) -> Callable[[], dict]:
    """Reading what is kept, or nothing if that names types which no longer exist."""

    def index() -> dict:
        try:
            return load()
        except (AttributeError, ImportError, ValueError, EOFError):
            return {}

    return index


@cache
def _sources(package: Path) -> str:
    """Hash of the sources of a package and of this one."""
    found = hashlib.sha256()
    for folder in sorted({package, Path(__file__).parent}):
        for file in sorted(folder.glob("*.py")):
            found.update(file.name.encode() + file.read_bytes())
    return found.hexdigest()
