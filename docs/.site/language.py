"""Finds words that this project does not use, too long sentences of pages, and docstrings without a noun or verb first.

python docs/.site/language.py          prints one line for each in code and in pages that are written by hand; exits with 1 if any
python docs/.site/language.py --all    the same of all pages
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MOST_WORDS = 25  # of a sentence in a page
# Avoided words, and their substitutes; parts of identifiers count as words.
WORDS = {
    "tells?|told|telling": "reports, returns, estimates",
    "knows?|knew": "has, within the trained domain",
    "comes? along": "is bundled",
    "errs?": "has an error of",
    "bears|borne": "transmits, supports",
    "(?<!dragon )skin": "surface",  # but for the silicone of that name
    "at hand": "current",
    "stations?": "cross-sections",
}
AVOIDED = {re.compile(rf"(?<![a-z])({words})(?![a-z])", re.IGNORECASE): better for words, better in WORDS.items()}
# First words of a docstring's sentence that is no question.
OPENING = re.compile(r"(?:\A|[.:;?!]\s|\n\s*\n)\W*(Of|What|Where|Whether|How)\b(?!(?:[^.!?]|[.!](?!\s))*\?)")
BY_HAND = (
    "README.md",
    "docs/index.md",
    "docs/format.md",
    "docs/theory",
    *(f"docs/{name}" for name in ("howto", "tutorials", "reference")),
    *("fingerfem", "rom", "control", "studies", "tests", "examples"),
)
FOLDERS = *BY_HAND, "docs"
KINDS = ".md", ".py", ".c", ".h", ".in", ".j2"
OTHERS_OWN = "node_modules", "samples", ".site", "test_language.py"  # text that is not ours, or names these words
FENCE = re.compile(r"^ *(```|~~~).*?^ *\1|^\$\$.*?\$\$", re.MULTILINE | re.DOTALL)  # code, and formulas of their own
IN_LINE = re.compile(
    r"\[[^]]*\]\([^)]*\)|`[^`]*`|\$[^$]*\$|<[^>]*>|\{[{%].*?[%}]\}"
)  # links, code, formulas: a word each
SENTENCE = re.compile(r"(?<=[.:;?!])\s+(?=\W*[A-Z])")
NO_PROSE = "|", "#", ":::", "---", "!", "<"


def files(names: tuple[str, ...]) -> Iterator[Path]:
    """Files of these names, and all texts in folders of these names."""
    for place in (ROOT / name for name in names):
        for file in [place] if place.is_file() else sorted(place.rglob("*")):
            if file.suffix in KINDS and not set(OTHERS_OWN) & set(file.parts):
                yield file


def avoided(text: str) -> Iterator[tuple[int, str]]:
    """Lines and complaints."""
    for number, line in enumerate(text.splitlines(), 1):
        for pattern, better in AVOIDED.items():
            for word in pattern.findall(line):
                yield number, f"write {better} for {word!r}"


def too_long(page: str) -> Iterator[tuple[int, str]]:
    """Sentences of a page in Markdown with too many words: their lines and complaints; code and tables are not read."""
    text, line = FENCE.sub(lambda code: "\n" * code[0].count("\n"), page), 1
    for part in re.split(r"(\n\s*\n|\n(?= *[-*] | *\d+\. ))", text):
        prose = " ".join(row for row in part.splitlines() if not row.lstrip().startswith(NO_PROSE))
        for sentence in SENTENCE.split(IN_LINE.sub("X", prose)):
            count = len(sentence.split())
            if count > MOST_WORDS:
                yield line, f"{count} words, at most {MOST_WORDS}: {sentence.strip()[:60]} ..."
        line += part.count("\n")


def openings(code: str) -> Iterator[tuple[int, str]]:
    """Sentences in docstrings of Python that begin with a word of OPENING: their lines and complaints."""
    for node in ast.walk(ast.parse(code)):
        if not isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            continue
        text = ast.get_docstring(node, clean=False) or ""
        for found in OPENING.finditer(text):
            line = node.body[0].lineno + text.count("\n", 0, found.start(1))
            yield line, f"begin with a noun or a verb in place of {found[1]!r}"


READERS = {".md": too_long, ".py": openings}  # of a kind of file, besides `avoided`


def complaints(names: tuple[str, ...] = BY_HAND) -> Iterator[str]:
    """One line for every word and sentence."""
    for file in files(names):
        text, own = file.read_text(), READERS.get(file.suffix)
        faults = [*avoided(text), *(own(text) if own else ())]
        yield from (f"{file.relative_to(ROOT)}:{line}: {complaint}" for line, complaint in faults)


if __name__ == "__main__":
    lines = list(complaints(FOLDERS if "--all" in sys.argv else BY_HAND))
    print("\n".join(lines))
    sys.exit(bool(lines))
