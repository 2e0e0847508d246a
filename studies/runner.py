"""The one runner of all studies: measures part by part into JSON, then writes each study's section of a page of docs/.

python3 -m studies.runner [NAME ...] [--quick] [--out OUT]      writes OUT (out/docs by default) and docs/

A study is a folder of studies/ with three files: `study.py` names its parts, functions that measure and return what
JSON can hold; `page.md.j2` is its section; `page.py`, if there is one, draws its pictures and prepares its tables. What
is measured stays in OUT/VERSION/NAME/PART.json, VERSION being a hash of the packages and scenes, so an interrupted run
goes on where it was, and no number outlives the code it was measured with. --quick measures the short forms, of which
no page is written.
"""

from __future__ import annotations

import argparse
import ast
import hashlib
import importlib
import inspect
import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from datetime import date
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import jinja2

from rom.whole_file import write_whole

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
# In this order: later ones use the snapshot sets of earlier ones.
STUDIES = (
    "solver",
    "training",
    "control",
    "tradeoff",
    "separated",
    "rods",
    "tapered",
    "grasping",
    "coverage",
    "extremes",
    "required",
    "figures",
    "peers",
)
# Pages with sections of several studies; the others have a page of their name.
PAGES = {
    "accuracy": ("rods", "tapered", "separated", "coverage"),
    "speed": ("tradeoff", "control"),
    "appendix": ("training", "solver", "extremes", "required", "figures"),
}
OUT = ROOT / "out" / "docs"
# A line for a page whose study has changed and is not measured again yet; the next measurement removes it.
AGED = "> An earlier version of this study measured these numbers; they are to be measured anew."
COMMIT = "FINGERFEM_COMMIT"  # the Makefile's word for where the checkout is


class Unmeasured(Exception):
    """A part that a page needs has not been measured."""


@dataclass(frozen=True)
class Run:
    """What a part measures with.

    Attributes:
        name: NAME/PART.
        folder: where the study keeps what it needs again; OUT/VERSION/NAME.
        sets: where all studies keep scenes and snapshot sets; OUT/VERSION/sets.
        quick: whether the short form is measured.
    """

    name: str
    folder: Path
    sets: Path
    quick: bool

    @property
    def file(self) -> Path:
        """What the part writes."""
        return self.folder / f"{self.name.split('/')[1]}.json"

    def once(self, key: str, measure: Callable[..., Any], *given: Any) -> Any:
        """What `measure(*given)` returns, or returned before the part was interrupted; printed when it is new."""
        file = self.file.with_suffix(".rows.json")
        kept = json.loads(file.read_text()) if file.exists() else {}
        own = kept.get("rows", {}) if kept.get("hash") == measuring_hash(self.name) else {}
        if key not in own:
            begun = time.perf_counter()
            own[key] = {"row": measure(*given), "seconds": time.perf_counter() - begun}
            write_json(file, {"hash": measuring_hash(self.name), "rows": own})
            print(f"  {key}: {own[key]['seconds']:.0f} s", flush=True)
            if isinstance(own[key]["row"], dict):
                say(own[key]["row"])
        return own[key]["row"]


def say(row: dict) -> None:
    """Print a row of a table; lists and tables within it are left to the file."""
    shown = {name: value for name, value in row.items() if not isinstance(value, list | dict)}
    print("    " + "  ".join(f"{name} {_short(value)}" for name, value in shown.items()), flush=True)


def _short(value: Any) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def write_json(file: Path, value: Any) -> None:
    """Write a file whole: a run that is killed leaves what the one before it had."""
    write_whole(file, lambda stream: stream.write(json.dumps(value, indent=1).encode()))


def hashed(files: list[Path], base: Path, content: Callable[[Path], bytes] = Path.read_bytes) -> str:
    """A hash of files, names and content."""
    found = hashlib.sha256()
    for file in sorted(files):
        found.update(f"{file.relative_to(base).as_posix()}\0".encode() + content(file) + b"\0")
    return found.hexdigest()[:12]


def without_imports(file: Path) -> bytes:
    """The content of a file without its import statements: a module that moves leaves a measured page fresh."""
    lines = file.read_bytes().splitlines(keepends=True)
    if file.suffix == ".py":
        for node in ast.walk(ast.parse(file.read_bytes())):
            if isinstance(node, ast.Import | ast.ImportFrom):
                lines[node.lineno - 1 : node.end_lineno] = [b""] * ((node.end_lineno or node.lineno) - node.lineno + 1)
    return b"".join(lines)


def sources(study: str) -> list[Path]:
    """A study's own files."""
    folder = ROOT / "studies" / study
    return [*folder.rglob("*.py"), *folder.rglob("*.j2")]


def page_of(study: str) -> Path:
    """The page with a study's section."""
    return DOCS / f"{next((page for page, studies in PAGES.items() if study in studies), study)}.md"


def section_of(study: str) -> str:
    """A study's section of its page, empty if there is none."""
    file = page_of(study)
    found = marks(study).search(file.read_text()) if file.exists() else None
    return found[0] if found else ""


def marks(study: str) -> re.Pattern[str]:
    """The marks of a study's section and what is between them."""
    return re.compile(rf"<!-- begin {study} -->\n.*?<!-- {study} \w+ -->\n", re.DOTALL)


def page_hash(study: str) -> str:
    """Of a study and its template: what a section must carry to be fresh."""
    return hashed(sources(study), ROOT, without_imports)


def measuring_hash(name: str) -> str:
    """Of what measures NAME/PART: the part's module and what that imports of its study.

    A study whose parts start other programs has a `folders.py` that names their sub-folders instead.
    """
    shown = ("page.py", "*.j2", "folders.py")  # what says how numbers are shown or kept, not which
    study, _, part = name.partition("/")
    folder = ROOT / "studies" / study
    files = [file for file in sources(study) if not any(file.match(pattern) for pattern in shown)]
    if known := folders(study):
        own = known.get(part)
        files = [file for file in files if own is None or file.parent == folder or file.parent.name in own]
    elif find_spec(f"studies.{study}") and (function := parts(study, False).get(name)):
        files = imported(Path(inspect.getfile(function)), folder)
    return hashed(files, ROOT)


def folders(study: str) -> dict[str, tuple[str, ...]]:
    """Sub-folders that parts of a study measure with, as its `folders.py` says; empty where there is none."""
    if not (ROOT / "studies" / study / "folders.py").exists():
        return {}
    return importlib.import_module(f"studies.{study}.folders").FOLDERS


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
    """Of the packages and scenes that are measured."""
    kinds = ("*.py", "*.c", "*.h", "*.in", "*.toml")
    folders = [ROOT / name for name in ("fingerfem", "rom", "control", "scenes")]
    return hashed([file for folder in folders for kind in kinds for file in folder.rglob(kind)], ROOT)


def measure(name: str, out: Path, quick: bool) -> None:
    """Measure one part in this process, and write its file."""
    run = place(name, out, quick)
    run.folder.mkdir(parents=True, exist_ok=True)
    run.sets.mkdir(parents=True, exist_ok=True)
    function = parts(name.split("/")[0], quick)[name]
    assert function is not None, f"{name} is measured by another Python"
    begun = time.perf_counter()
    result = function(run)
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


def place(name: str, out: Path, quick: bool) -> Run:
    """Where a part keeps its things."""
    folder = out / (f"{version()}-quick" if quick else version())
    return Run(name, folder / name.split("/")[0], folder / "sets", quick)


def read(name: str, out: Path, quick: bool = False) -> dict | None:
    """What a part has written, None if it has not or if its study has changed since."""
    file = place(name, out, quick).file
    found = json.loads(file.read_text()) if file.exists() else None
    return found if found and found["hash"] == measuring_hash(name) else None


def parts(study: str, quick: bool) -> dict[str, Callable[[Run], Any] | None]:
    """What measures, by NAME/PART; None for what only another Python can."""
    module = importlib.import_module(f"studies.{study}.study")
    left_out = getattr(module, "FULL_ONLY", ()) if quick else ()
    return {f"{study}/{part}": function for part, function in module.PARTS.items() if part not in left_out}


def complete(study: str, out: Path, quick: bool) -> None:
    """Measure whatever of a study is not there, each part in a process of its own."""
    for name, function in parts(study, quick).items():
        if read(name, out, quick):
            print(f"{name}: kept", flush=True)
            continue
        if function is None:
            print(f"{name}: measured by another Python, see make docs", flush=True)
            continue
        print(f"{name}", flush=True)
        words = [sys.executable, "-m", "studies.runner", "--part", name, "--out", str(out)]
        done = subprocess.run(words + ["--quick"] * quick, cwd=ROOT)
        if done.returncode:
            raise SystemExit(f"{name} ended with exit code {done.returncode}; what it had measured is kept")


def results(study: str, out: Path, quick: bool = False) -> tuple[dict[str, Any], dict[str, dict]]:
    """What the parts of a study found, and where from, by part."""
    found, origin = {}, {}
    for name in parts(study, quick):
        one = read(name, out, quick)
        if one is None:
            raise Unmeasured(f"docs/{page_of(study).name} not written: {name} must be measured first, see make docs")
        part = name.split("/")[1]
        found[part], origin[part] = one.pop("result"), one
    return found, origin


def write_page(study: str, out: Path) -> None:
    """Write a study's pictures and its section of a page from what its parts measured."""
    found, origin = results(study, out)
    folder = ROOT / "studies" / study
    if (folder / "page.py").exists():
        page = importlib.import_module(f"studies.{study}.page")
        found |= page.prepare(found, place(f"{study}/", out, quick=False).folder)
    text = templates().get_template(f"{study}/page.md.j2").render(found)
    section = f"<!-- begin {study} -->\n{text.rstrip()}\n\n{provenance(study, origin)}"
    file, old = page_of(study), section_of(study)
    before = file.read_text() if file.exists() else ""
    file.write_text(before.replace(old, section) if old else f"{before}\n{section}".lstrip())
    print(f"docs/{page_of(study).name} written", flush=True)


def provenance(study: str, origin: dict[str, dict]) -> str:
    """The section's last lines: where its numbers are from."""
    commits = sorted({one["commit"] for one in origin.values()})
    dates, cores = (sorted({one[key] for one in origin.values()}) for key in ("date", "cores"))
    minutes = ", ".join(f"{part} {one['seconds'] / 60:.1f}" for part, one in origin.items())
    where = f"commit {' and '.join(commits)}, {' to '.join(dates[:: max(len(dates) - 1, 1)])}"
    return (
        f"---\n\nMeasured by `make docs` (`python3 -m studies.runner {study}`): {where}, {cores[-1]} cores; minutes: "
        f"{minutes}.\n<!-- {study} {page_hash(study)} -->\n"
    )


def stale() -> list[str]:
    """One line for every section of an older version of its study or template, but for those with AGED."""
    found = []
    for study in STUDIES:
        text = section_of(study)
        if f"<!-- {study} {page_hash(study)} -->" not in text and AGED not in text:
            found.append(f"docs/{page_of(study).name} is not of this studies/{study}: make docs")
    return found


def templates() -> jinja2.Environment:
    """Where pages come from: a missing number is an error, and lines of logic leave no trace."""
    found = jinja2.Environment(
        loader=jinja2.FileSystemLoader(ROOT / "studies"),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
    )
    found.filters |= {"percent": percent, "number": number, "over": over}
    return found


def percent(share: float) -> str:
    """A share for people: 0.0123 is 1.2 %."""
    return f"{100 * share:.0f} %" if share >= 0.1 else f"{100 * share:.2g} %"


def number(value: float | None, digits: int = 3) -> str:
    """A number for people: whole ones and thousands with commas, others to some digits, none as a dash."""
    if value is None:
        return "-"
    return f"{value:,.0f}" if isinstance(value, int) or 10**digits <= value < 1e6 else f"{value:.{digits}g}"


def over(row: dict, key: str, reference: dict) -> str:
    """One row's number as a multiple of another's: seconds depend on the machine, ratios less."""
    return f"{row[key] / reference[key]:.2f}" if row.get(key) is not None else "-"


def main() -> None:
    """Measure, write the pages."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("studies", nargs="*", choices=[*STUDIES, []], help="all by default")
    parser.add_argument("--out", type=Path, default=OUT)
    parser.add_argument("--quick", action="store_true", help="the short forms; no page is written")
    parser.add_argument("--part", help=argparse.SUPPRESS)
    options = parser.parse_args()
    out = options.out.resolve()
    if options.part:
        return measure(options.part, out, options.quick)
    for study in options.studies or STUDIES:
        complete(study, out, options.quick)
        if not options.quick:
            try:
                write_page(study, out)
            except Unmeasured as missing:
                print(missing, flush=True)


if __name__ == "__main__":
    main()
