"""Runs the commands and the code of the hand-written pages, and writes what they print to docs/reference/samples/.

python3 docs/.site/samples.py [PAGE.md ...]      all pages if none is named; some minutes

Python and commands are run by .venv (make .venv/ready), those that need DOLFINx by docker/run.

A page shows what a block prints by including it in the next one:

    ```bash
    python3 -m rom info rom/finger.h5
    ```

    ```text
    --8<-- "rom-info.txt"
    ```

"rom-info.txt:1:3" shows its first three lines. Commands without such an inclusion are not run; of a page with one after
a Python block, all Python blocks are, one after another. A block with a title is a file. Files that pages write to
mine/ and out/ are kept in out/samples/.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS, SAMPLES, WORK = ROOT / "docs", ROOT / "docs" / "reference" / "samples", ROOT / "out" / "samples"
BLOCK = re.compile(
    r'^```(?:(bash|python)|\w+ title="(.*?)")\n(.*?)^```\n(?:\n```\w*\n--8<-- "([^:"]*)[:\d]*"\n```\n)?',
    re.DOTALL | re.MULTILINE,
)
PATH = f"{ROOT / '.venv' / 'bin'}{os.pathsep}{os.environ['PATH']}"
SETTINGS = os.environ | {"PATH": PATH, "PYTHONPATH": str(ROOT)}
MOVED = re.compile(r"(?<![\w/.])(mine|out)/")  # folders of pages
PYTHON = """
import contextlib, io, json, sys
names, printed = {"__name__": "__main__"}, []
for code in json.load(open(sys.argv[1])):
    with contextlib.redirect_stdout(io.StringIO()) as said:
        exec(code, names)
    printed.append(said.getvalue())
json.dump(printed, open(sys.argv[1], "w"))
"""


def moved(text: str) -> str:
    """A command or code that keeps in out/samples/ what it would keep in mine/ and out/."""
    return MOVED.sub(r"out/samples/\1/", text)


def shown(text: str) -> str:
    """Printed text with the page's folders in place of this machine's."""
    text = re.sub(r"out/samples/(mine|out)/", r"\1/", text).replace(str(ROOT), "~/fingerfem")
    return "\n".join(line.rstrip() for line in text.replace("\r", "").strip("\n").splitlines()) + "\n"


def run(line: str) -> str:
    """Output of a command, and its exit code if that is not 0."""
    full_order = line.startswith("python3 -m fingerfem ") and not line.endswith(" --help")
    words = f"docker/run {line}" if full_order else line
    done = subprocess.run(
        moved(words), shell=True, cwd=ROOT, env=SETTINGS, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    if done.returncode:
        print(f"    exit code {done.returncode}: {line}", flush=True)
    return done.stdout + (f"(exit code {done.returncode})\n" if done.returncode else "")


def python(blocks: list[str]) -> list[str]:
    """Outputs of blocks of code, run one after another."""
    file = WORK / "blocks.json"
    file.write_text(json.dumps([moved(block) for block in blocks]))
    subprocess.run([ROOT / ".venv" / "bin" / "python", "-c", PYTHON, file], cwd=ROOT, env=SETTINGS, check=True)
    return json.loads(file.read_text())


def write(page: Path) -> None:
    """Run a page's blocks in their order and write their samples."""
    blocks = BLOCK.findall(page.read_text())
    for folder in ("mine", "out"):
        if folder == "out" or any(file.startswith("mine/") for _, file, _, _ in blocks):
            shutil.rmtree(WORK / folder, ignore_errors=True)  # a whole one would not be solved again
        (WORK / folder).mkdir(parents=True, exist_ok=True)
    codes = [code for kind, _, code, _ in blocks if kind == "python"]
    printed = None
    for kind, file, code, sample in blocks:
        if file:
            (ROOT / moved(file)).write_text(code)
        if not sample:
            continue
        print(f"{page.relative_to(DOCS)}: {sample}", flush=True)
        if kind == "python":
            printed = python(codes) if printed is None else printed
            text = printed[codes.index(code)]
        else:
            text = "".join(run(line) for line in code.splitlines())
        (SAMPLES / sample).write_text(shown(text))


if __name__ == "__main__":
    named = [Path(word).resolve() for word in sys.argv[1:]]
    # Other pages use the tutorials' models.
    pages = sorted(DOCS.rglob("*.md"), key=lambda page: (page.parent.name != "tutorials", page))
    for page in named or pages:
        if '\n--8<-- "' in page.read_text():
            write(page)
