"""Report of an installation: its parts, their faults, and the remedies."""

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Literal

Verdict = Literal["ok", "slow", "wrong"]
RUNNING = ("numpy", "scipy", "h5py", "cffi", "pydantic", "typer", "rich")
TRAINING = ("mpi4py", "petsc4py", "ufl", "ffcx", "dolfinx")
DOLFINX = (0, 9), (0, 11)  # oldest and newest that this project was run with
PAIR = "from mpi4py import MPI; w = MPI.COMM_WORLD; print(w.allreduce(w.rank + 1), w.size)"


@dataclass(frozen=True)
class Finding:
    """One thing looked at: its name, the verdict, what was found, and what to do if that is not well."""

    name: str
    verdict: Verdict
    found: str
    remedy: str = ""


def examine() -> Iterator[Finding]:
    """Look at everything, from Python to the display; nothing raises."""
    for look in (
        _python,
        _mpirun,
        _packages,
        _mpi,
        _mumps,
        _blas,
        _threads,
        _cores,
        _locks,
        _compiler,
        _cache,
        _display,
    ):
        try:
            yield from look()
        except Exception as error:
            yield Finding(look.__name__[1:], "wrong", f"{type(error).__name__}: {error}", "see the lines above")


def _python() -> Iterator[Finding]:
    version = sys.version.split()[0]
    yield _judge("Python", sys.version_info >= (3, 11), version, "install Python 3.11 or newer")


def _packages() -> Iterator[Finding]:
    for name in (*RUNNING, *TRAINING):
        try:
            version = str(getattr(import_module(name), "__version__", "there"))
        except Exception as error:
            how = f"Debian 13: python3-{name}; conda-forge: fenics-{name}" if name == "dolfinx" else f"install {name}"
            yield Finding(name, "wrong", f"{type(error).__name__}: {error}", how)
            continue
        fits = True
        if name == "dolfinx":
            fits = DOLFINX[0] <= tuple(int(part) for part in version.split(".")[:2]) <= DOLFINX[1]
        yield _judge(name, fits, version, "install DOLFINx 0.9 to 0.11")


def _mumps() -> Iterator[Finding]:
    from petsc4py import PETSc

    version = ".".join(map(str, PETSc.Sys.getVersion()))
    has = PETSc.Sys.hasExternalPackage("mumps")
    yield _judge("MUMPS", has, f"{'in' if has else 'not in'} PETSc {version}", "take a PETSc configured with MUMPS")


def _blas() -> Iterator[Finding]:
    import_module("petsc4py.PETSc")
    maps = Path("/proc/self/maps").read_text()
    fast = next((name for name in ("openblas", "mkl", "blis") if name in maps), None)
    library = fast or "reference BLAS, several times slower in MUMPS"
    yield Finding("BLAS", "ok" if fast else "slow", library, "Debian: apt-get install libopenblas0-pthread")


def _mpi() -> Iterator[Finding]:
    from mpi4py import MPI

    yield Finding("MPI", "ok", MPI.Get_library_version().split(",")[0].split("\n")[0].strip("\0"))


def _mpirun() -> Iterator[Finding]:
    """Before this process starts MPI itself, which a child would inherit."""
    if shutil.which("mpirun") is None:
        yield Finding("mpirun", "wrong", "not found", "install the MPI's programs (Debian: openmpi-bin)")
        return
    pair = ["mpirun", "-n", "2", sys.executable, "-c", PAIR]
    done = subprocess.run(pair, capture_output=True, text=True, timeout=60)
    if done.returncode:
        said = done.stderr.strip().splitlines() or ["it failed and said nothing"]
        yield Finding("mpirun", "wrong", said[-1], "mend what it says")
    else:
        seen = "3 2" in done.stdout.splitlines()
        verdict = "two ranks see each other" if seen else "its ranks do not see each other"
        yield _judge("mpirun", seen, verdict, "mpirun and mpi4py must be of one MPI")


def _threads() -> Iterator[Finding]:
    count = os.environ.get("OMP_NUM_THREADS", "unset")
    yield Finding(
        "threads",
        "ok" if count == "1" else "slow",
        f"OMP_NUM_THREADS {count}",
        "export OMP_NUM_THREADS=1: ranks share the cores, threads fight for them",
    )


def _cores() -> Iterator[Finding]:
    cores = len(os.sched_getaffinity(0))
    free = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_AVPHYS_PAGES") / 2**30
    yield Finding("cores", "ok", f"{cores} usable, {free:.1f} GB of memory free: up to {cores} ranks")


def _locks() -> Iterator[Finding]:
    from fingerfem.snapshots.claims import why_no_locks

    with tempfile.TemporaryDirectory(dir=".") as folder:
        reason = why_no_locks(Path(folder))
    remedy = "sets here work, by claim files; a killed rank's line waits two minutes for another machine"
    yield Finding("locks", "slow" if reason else "ok", reason or f"work in {Path.cwd()}", remedy)


def _compiler() -> Iterator[Finding]:
    command = os.environ.get("CC", "gcc").split()[0]
    where = shutil.which(command)
    yield _judge("C compiler", where is not None, where or f"{command} not found", "install gcc and libc6-dev")


def _cache() -> Iterator[Finding]:
    from fingerfem.discretisation.form_cache import cache_folder

    folder = cache_folder()
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(dir=folder):
        free = shutil.disk_usage(folder).free / 2**30
    yield Finding("form cache", "ok" if free > 0.1 else "wrong", f"{folder}, {free:.1f} GB free", "free some space")


def _display() -> Iterator[Finding]:
    display = "DISPLAY is set" if os.environ.get("DISPLAY") else shutil.which("xvfb-run")
    yield Finding(
        "display", "ok" if display else "slow", display or "none: no pictures", "Debian: apt-get install xvfb xauth"
    )


def _judge(name: str, well: bool, found: str, remedy: str) -> Finding:
    return Finding(name, "ok" if well else "wrong", found, remedy)


def report() -> list[Finding]:
    """Print every finding as it is made, with the remedy where one is needed."""
    findings = []
    for finding in examine():
        findings.append(finding)
        print(f"{finding.verdict:6s} {finding.name:12s} {finding.found}", flush=True)
        if finding.verdict != "ok":
            print(f"{'':19s} -> {finding.remedy}", flush=True)
    return findings


if __name__ == "__main__":  # works without even the command line's own packages
    raise SystemExit(3 if any(finding.verdict == "wrong" for finding in report()) else 0)
