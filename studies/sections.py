"""Sections of pages: written from what the parts of a study measured, and checked to be of its present version."""

from __future__ import annotations

import ast
import importlib
import re
import shutil
from pathlib import Path

import jinja2

from studies.declared import STUDIES
from studies.parts import ROOT, hashed, place, results, sources

DOCS = ROOT / "docs"
# A line for a page whose study has changed and is not measured again yet; the next measurement removes it.
AGED = "> An earlier version of this study measured these numbers; they are to be measured anew."


def without_imports(file: Path) -> bytes:
    """The content of a file without its import statements: a module that moves leaves a measured page fresh."""
    lines = file.read_bytes().splitlines(keepends=True)
    if file.suffix == ".py":
        for node in ast.walk(ast.parse(file.read_bytes())):
            if isinstance(node, ast.Import | ast.ImportFrom):
                lines[node.lineno - 1 : node.end_lineno] = [b""] * ((node.end_lineno or node.lineno) - node.lineno + 1)
    return b"".join(lines)


def page_of(study: str) -> Path:
    """The page with a study's section."""
    return DOCS / f"{STUDIES[study].page}.md"


def section_of(study: str) -> str:
    """A study's section of its page, empty if there is none."""
    file = page_of(study)
    found = marks(study).search(file.read_text()) if file.exists() else None
    return found[0] if found else ""


def marks(study: str) -> re.Pattern[str]:
    """The marks of a study's section and what is between them."""
    return re.compile(rf"<!-- begin {study} -->\n.*?<!-- {study} \w+ -->\n", re.DOTALL)


def page_hash(study: str) -> str:
    """Hash of a study and its template, which its section must have to be fresh."""
    return hashed(sources(study), ROOT, without_imports)


def write_page(study: str, out: Path) -> None:
    """Write a study's pictures and its section of a page from what its parts measured."""
    found, origin = results(study, out)
    measured = place(f"{study}/", out).folder
    for picture in (*measured.glob("*.png"), *measured.glob("*.webp")):
        shutil.copy(picture, DOCS)
    if (ROOT / "studies" / study / "page.py").exists():
        page = importlib.import_module(f"studies.{study}.page")
        found |= page.prepare(found, measured)
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
    where = f"commit {' and '.join(commits)}, {' to '.join(dates[:: max(len(dates) - 1, 1)])}"
    return (
        f"---\n\nMeasured by `make docs` (`studies.runner {study}`): {where}, {cores[-1]} cores.\n"
        f"<!-- {study} {page_hash(study)} -->\n"
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
    """Environment of the templates: a missing number is an error, and lines of logic leave no trace."""
    found = jinja2.Environment(
        loader=jinja2.FileSystemLoader(ROOT / "studies"),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
    )
    found.filters |= {"percent": percent, "number": number, "spread": spread}
    return found


def percent(share: float) -> str:
    """A share for people: 0.0123 is 1.2 %."""
    return f"{100 * share:.0f} %" if share >= 0.1 else f"{100 * share:.2g} %"


def number(value: float | None, digits: int = 3) -> str:
    """A number for people: whole ones and thousands with commas, others to some digits, none as a dash."""
    if value is None:
        return "-"
    return f"{value:,.0f}" if isinstance(value, int) or 10**digits <= value < 1e6 else f"{value:.{digits}g}"


def spread(row: dict, unit: str = "%") -> str:
    """Median, 95th percentile and largest in one cell, `0.033, 0.29, 7 %`: shares, or values in another unit."""
    if not row.get("count", 1):
        return "-"
    values = [row[name] for name in ("median", "p95", "max")]
    words = [percent(value).removesuffix(" %") if unit == "%" else number(value, 2) for value in values]
    return f"{', '.join(words)} {unit}"
