"""Compiled forms in a cache of the project's own, shared by all processes of a machine.

Every form and expression has a folder of its own, named after all that its code depends on. It is compiled in a private
folder beside that one, which is renamed when it is whole: what the cache holds is never half there, whoever is killed
whenever, and nobody writes where another process reads or writes. A lock by form lets one of many processes compile it
while the others wait. It only saves work: who has waited for too long, or has no locks, compiles for itself.
"""

import fcntl
import os
import shutil
import socket
import sys
import sysconfig
import time
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, BinaryIO

import dolfinx
import ffcx
import numpy as np
import ufl
from cffi import VerificationError
from dolfinx import fem, jit
from ffcx.naming import compute_signature
from mpi4py import MPI
from ufl.classes import Label
from ufl.corealg.map_dag import map_expr_dag
from ufl.corealg.multifunction import MultiFunction

NOTICE = 10.0  # [s] of waiting for another process, after which it is said; few forms take as long to compile
PATIENCE = 120.0  # [s] of waiting, after which a form is compiled here too: whoever compiles it may be stopped
ABANDONED = 86400.0  # [s]: a private folder that has not changed for a day was left by a process that was killed
COMPILER_FLAGS = ["-O1", "-g0"]  # -O2 compiles for two to three times as long, and its forms are as fast


def cache_folder() -> Path:
    """Folder of compiled forms, which nothing else uses."""
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "fingerfem" / "forms"


def form(integrals: ufl.Form) -> fem.Form:
    """A compiled form that DOLFINx 0.9 assembles whole: one integral a region (collective over the mesh's ranks).

    Raises:
        OSError: it cannot be compiled; on every rank.
    """
    folder = _compiled(integrals, integrals.ufl_domain().ufl_cargo().comm)
    made = fem.form(integrals, dolfinx.default_scalar_type, jit_options=_jit_options(folder))
    for kind in (fem.IntegralType.cell, fem.IntegralType.exterior_facet):
        regions = list(made._cpp_object.integral_ids(kind))
        if len(set(regions)) < len(regions):
            raise AssertionError(f"a form has two integrals over one of the regions {regions}")
    return made


def forms(tree: Any) -> Any:
    """Compiled forms in place of UFL's in a tree of dicts and lists; what else is in it stays as it is.

    Processes that begin together share the work: each compiles what no other is at, before it waits for the others'.

    Raises:
        OSError: as `form` does.
    """
    for integrals in _leaves(tree):
        if integrals.ufl_domain().ufl_cargo().comm.rank == 0:
            with suppress(Exception):  # `form` tries once more, and informs all ranks
                _compile_once(integrals, cache_folder() / _name(integrals), waits=False)
    return _compiled_tree(tree)


def _leaves(tree: Any) -> list[ufl.Form]:
    if isinstance(tree, ufl.Form):
        return [tree]
    parts = list(tree.values()) if isinstance(tree, dict) else tree
    return [leaf for part in parts for leaf in _leaves(part)] if isinstance(parts, list) else []


def _compiled_tree(tree: Any) -> Any:
    if isinstance(tree, dict):
        return {name: _compiled_tree(part) for name, part in tree.items()}
    if isinstance(tree, list):
        return [_compiled_tree(part) for part in tree]
    return form(tree) if isinstance(tree, ufl.Form) else tree


def expression(value: Any, points: np.ndarray) -> fem.Expression:
    """An expression compiled for points of the reference cell, shape (n, 3) (collective over the mesh's ranks).

    Raises:
        OSError: it cannot be compiled; on every rank.
    """
    value = _with_numbered_labels(value)
    folder = _compiled((value, points), ufl.domain.extract_unique_domain(value).ufl_cargo().comm)
    return fem.Expression(value, points, jit_options=_jit_options(folder), dtype=dolfinx.default_scalar_type)


class _NumberedLabels(MultiFunction):
    """An expression with its labels of `ufl.variable` counted anew, in the order in which they are found."""

    def __init__(self) -> None:
        super().__init__()
        self._labels: dict[Label, Label] = {}

    expr = MultiFunction.reuse_if_untouched

    def label(self, label: Label) -> Label:
        return self._labels.setdefault(label, Label(len(self._labels)))


def _with_numbered_labels(value: Any) -> Any:
    """The same expression under a name that does not depend on what the process made before.

    UFL counts the labels of all its expressions together. FFCx hashes these counts with an expression, though not with
    a form: without this every process would compile moduli that lie in the cache already.
    """
    return map_expr_dag(_NumberedLabels(), value)


def _compiled(source: Any, comm: MPI.Comm) -> Path:
    """The folder with the code of a form, or of an expression and its points; the ranks' first one compiles it."""
    folder, error = cache_folder() / _name(source), None
    for mine in (comm.rank == 0, comm.rank != 0):  # the others find it whole, unless they do not see the first's disk
        if mine:
            try:
                _compile_once(source, folder)
            except Exception as caught:
                error = caught
        for raised in comm.allgather(error):
            if raised is not None:
                raise raised
    return folder


def _jit_options(folder: Path | None = None) -> dict[str, Any]:
    return {"cffi_extra_compile_args": COMPILER_FLAGS} | ({"cache_dir": folder} if folder else {})


def _name(source: Any) -> str:
    """A hash of all that the compiled code depends on: at least of what FFCx names its modules after."""
    options = {name: value for name, value in jit.get_options(_jit_options()).items() if name.startswith("cffi_")}
    options |= ffcx.get_options({"scalar_type": dolfinx.default_scalar_type})
    built = [dolfinx.__version__, *map(sysconfig.get_config_var, ("CFLAGS", "SOABI", "EXT_SUFFIX"))]
    return compute_signature([source], f"{sorted(options.items())} {built}")


def _compile_once(source: Any, folder: Path, waits: bool = True) -> None:
    """Fill a form's folder, unless it is there, or another process is at it and one does not wait."""
    if folder.exists():
        return
    folder.parent.mkdir(parents=True, exist_ok=True)
    with _turn(folder, waits) as mine:
        if mine and not folder.exists():
            _remove_abandoned(folder.parent)
            _compile(source, folder)


def _compile(source: Any, folder: Path) -> None:
    """Compile in a private folder and rename it, until there is a whole one: here or, meanwhile, by somebody else."""
    while not folder.exists():
        private = folder.with_name(f"{folder.name}.{socket.gethostname()}-{os.getpid()}-{uuid.uuid4().hex[:8]}")
        try:
            private.mkdir(parents=True)
            scalar = {"scalar_type": dolfinx.default_scalar_type}
            jit.ffcx_jit(MPI.COMM_SELF, source, form_compiler_options=scalar, jit_options=_jit_options(private))
            private.rename(folder)
        except (OSError, ImportError, VerificationError) as error:
            cleared = not private.exists() and folder.parent.exists()  # `rm -r` of the whole cache, say: once more
            if not cleared and not folder.exists():
                raise OSError(f"form cache {folder.parent}: forms must compile, got {_line(error)}") from error
        finally:
            shutil.rmtree(private, ignore_errors=True)


def _line(error: Exception) -> str:
    """Message of an error as one line."""
    return " ".join(str(error).split()) or type(error).__name__


@contextmanager
def _turn(folder: Path, waits: bool) -> Iterator[bool]:
    """Lock under which one process at a time compiles a folder's form; the kernel frees a killed one's lock.

    It is entered without the lock when the folder is whole, when PATIENCE is at an end, or where there are no locks;
    and with False, for nothing to do, when another process has the lock and one does not wait.
    """
    begun, said = time.monotonic(), False
    with open(folder.parent / "locks", "a+b") as locks:
        while not (mine := _locked(locks, folder)) and waits and not folder.exists():
            waited = time.monotonic() - begun
            if waited > PATIENCE:
                break
            if waited > NOTICE and not said and MPI.COMM_WORLD.rank == 0:
                print(f"waiting for {_owners(folder)} to compile a form; after {PATIENCE:g} s it is compiled here too",
                      file=sys.stderr, flush=True)  # fmt: skip
                said = True
            time.sleep(0.02)
        yield mine or waits


def _locked(locks: BinaryIO, folder: Path) -> bool:
    """True if the lock on a form's byte of the file of locks was free, or there are no locks at all."""
    try:
        fcntl.lockf(locks, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, int(folder.name[:15], 16))
    except (BlockingIOError, PermissionError):
        return False
    except OSError:
        return True
    return True


def _owners(folder: Path) -> str:
    """Machine and process numbers of those who compile what a folder is to hold."""
    private = folder.parent.glob(f"{folder.name}.*")
    names = {path.name.partition(".")[2].rpartition("-")[0] for path in private}
    return " or ".join(sorted(names)) or "another process"


def _remove_abandoned(cache: Path) -> None:
    """Remove what killed processes have left. A living one, stopped for a day, would begin its form once more."""
    for private in cache.glob("[0-9a-f]" * 40 + ".*-*-*"):
        with suppress(OSError):  # somebody else removes it, or renames it
            if time.time() - private.stat().st_mtime > ABANDONED:
                shutil.rmtree(private, ignore_errors=True)
