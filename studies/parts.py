"""The parts of studies: measured one by one, and kept in JSON files.

A part's result is OUT/VERSION/NAME/PART.json, VERSION being a hash of the packages and scenes. An interrupted run
continues; no number outlives the code that measured it.
"""

from __future__ import annotations

import ast
import hashlib
import importlib
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Any

from rom.files.atomic_file import write_whole
from studies.declared import STUDIES

ROOT = Path(__file__).resolve().parents[1]
COMMIT = "FINGERFEM_COMMIT"  # variable with the commit of the checkout; the Makefile sets it


class Unmeasured(Exception):
    """A part that a page needs has not been measured."""


@dataclass(frozen=True)
class Run:
    """A part, NAME/PART; the folder of its study, and that of the scenes and snapshot sets of all studies."""

    name: str
    folder: Path
    sets: Path

    @property
    def file(self) -> Path:
        """File of the part's result."""
        return self.folder / f"{self.name.split('/')[1]}.json"

    def once(self, key: str, measure: Callable[..., Any], *given: Any) -> Any:
        """Result of `measure(*given)`, kept if the part was interrupted; printed when it is new."""
        file = self.file.with_suffix(".rows.json")
        kept = json.loads(file.read_text()) if file.exists() else {}
        own = kept.get("rows", {}) if kept.get("hash") == measuring_hash(self.name) else {}
        if key not in own:
            begun = time.perf_counter()
            own[key] = {"row": measure(*given), "seconds": time.perf_counter() - begun}
            write_json(file, {"hash": measuring_hash(self.name), "rows": own})
            print(f"  {key}: {own[key]['seconds']:.0f} s", flush=True)
        return own[key]["row"]


def write_json(file: Path, value: Any) -> None:
    """Write a file whole: a run that is killed leaves what the one before it had."""
    write_whole(file, lambda stream: stream.write(json.dumps(value, indent=1).encode()))


def hashed(files: list[Path], base: Path, content: Callable[[Path], bytes] = Path.read_bytes) -> str:
    """A hash of files, names and content."""
    found = hashlib.sha256()
    for file in sorted(files):
        found.update(f"{file.relative_to(base).as_posix()}\0".encode() + content(file) + b"\0")
    return found.hexdigest()[:12]


def sources(study: str) -> list[Path]:
    """A study's own files."""
    folder = ROOT / "studies" / study
    return [*folder.rglob("*.py"), *folder.rglob("*.j2")]


def measuring_hash(name: str) -> str:
    """Hash of the code of NAME/PART: the part's module and those of its study that this imports."""
    study, _, part = name.partition("/")
    folder = ROOT / "studies" / study
    module = STUDIES[study].parts[part].partition(":")[0]
    return hashed(imported(folder.joinpath(*module.split(".")).with_suffix(".py"), folder), ROOT)


def imported(file: Path, folder: Path) -> list[Path]:
    """A module of a study's folder, and all modules of the folder that it imports."""
    found, left = set(), [file]
    while left:
        one = left.pop()
        if one in found:
            continue
        found.add(one)
        for node in ast.walk(ast.parse(one.read_bytes())):
            if not isinstance(node, ast.ImportFrom) or node.module is None:
                continue
            place = ROOT.joinpath(*node.module.split("."))
            names = [place.with_suffix(".py"), *(place / f"{alias.name}.py" for alias in node.names)]
            left += [path for path in names if path.is_relative_to(folder) and path.exists()]
    return sorted(found)


def version() -> str:
    """Hash of the packages and scenes that are measured."""
    kinds = ("*.py", "*.c", "*.h", "*.in", "*.toml")
    folders = [ROOT / name for name in ("fingerfem", "rom", "control", "scenes")]
    return hashed([file for folder in folders for kind in kinds for file in folder.rglob(kind)], ROOT)


def measure(name: str, out: Path) -> None:
    """Measure one part in this process and write its file, unless it is there."""
    if read(name, out):
        return print(f"{name}: kept", flush=True)
    run = place(name, out)
    run.folder.mkdir(parents=True, exist_ok=True)
    run.sets.mkdir(parents=True, exist_ok=True)
    begun = time.perf_counter()
    result = function_of(name)(run)
    finished(run, result, time.perf_counter() - begun)


def finished(run: Run, result: Any, seconds: float) -> None:
    """Write what a part measured, with where it comes from."""
    origin = {
        "hash": measuring_hash(run.name),
        "commit": os.environ.get(COMMIT, "unknown"),
        "date": date.today().isoformat(),
        "cores": len(os.sched_getaffinity(0)),
        "seconds": seconds,
    }
    write_json(run.file, origin | {"result": result})


def place(name: str, out: Path) -> Run:
    """Run of a part, with its folders."""
    folder = out / version()
    return Run(name, folder / name.split("/")[0], folder / "sets")


def read(name: str, out: Path) -> dict | None:
    """The file of a part; None if it is missing, or if the study has changed since."""
    file = place(name, out).file
    found = json.loads(file.read_text()) if file.exists() else None
    return found if found and found["hash"] == measuring_hash(name) else None


def parts(study: str) -> list[str]:
    """Names of its parts, NAME/PART."""
    return [f"{study}/{part}" for part in STUDIES[study].parts]


def function_of(name: str) -> Callable[[Run], Any]:
    """The function that measures NAME/PART."""
    study, _, part = name.partition("/")
    module, _, function = STUDIES[study].parts[part].partition(":")
    return getattr(importlib.import_module(f"studies.{study}.{module}"), function or "measure")


def complete(study: str, out: Path) -> None:
    """Measure the missing parts of a study, each in a process of its own; those of another Python are left out."""
    for name in parts(study):
        if name.split("/")[1] in STUDIES[study].elsewhere:
            continue
        print(name, flush=True)
        words = [sys.executable, "-m", "studies.runner", "--part", name, "--out", str(out)]
        done = subprocess.run(words, cwd=ROOT)
        if done.returncode:
            raise SystemExit(f"{name} ended with exit code {done.returncode}; what it had measured is kept")


def results(study: str, out: Path) -> tuple[dict[str, Any], dict[str, dict]]:
    """Results of the parts of a study, and their commits, dates and times, by part."""
    found, origin = {}, {}
    for name in parts(study):
        one = read(name, out)
        if one is None:
            reason = f"{name} must be measured first, with sources that do not change meanwhile: see make docs"
            raise Unmeasured(f"docs/{STUDIES[study].page}.md not written: {reason}")
        part = name.split("/")[1]
        found[part], origin[part] = one.pop("result"), one
    return found, origin
