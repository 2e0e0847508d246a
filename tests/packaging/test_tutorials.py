"""The code of the tutorials runs without DOLFINx, and prints what the page shows."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PAGES = ["tutorials/first-grasp.md", "tutorials/your-loop.md", "howto/objects.md", "howto/look.md"]
BLOCK = re.compile(r'^```python\n(.*?)^```\n(?:\n```text\n--8<-- "(.*?)"\n```\n)?', re.DOTALL | re.MULTILINE)
NUMBER = re.compile(r"-?\d+\.?\d*(?:e[+-]?\d+)?")
END = "=== end of a block ==="


@pytest.mark.parametrize("page", PAGES)
def test_code_runs_and_prints_what_the_page_shows(page, tmp_path):
    text = (DOCS / page).read_text()
    if "[gymnasium]" in text:
        pytest.importorskip("gymnasium")
    blocks = BLOCK.findall(text)
    assert blocks
    code = "".join(f"{code}\nprint({END!r})\n" for code, _ in blocks)
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    for printed, (_, sample) in zip(done.stdout.split(END + "\n"), blocks, strict=False):
        if sample:
            shown = (DOCS / "reference" / "samples" / sample).read_text()
            assert words(printed) == words(shown), f"{sample}: python3 docs/.site/samples.py docs/{page}"
            assert numbers(printed) == pytest.approx(numbers(shown), rel=0.02, abs=0.01)


def words(text: str) -> list[str]:
    """Words of a text without its numbers, however far apart."""
    return NUMBER.sub("", text).split()


def numbers(text: str) -> list[float]:
    return [float(word) for word in NUMBER.findall(text)]


def test_the_first_grasp_s_command_answers_as_its_code(tmp_path):
    page = (DOCS / "tutorials" / "first-grasp.md").read_text()
    (command,) = re.findall(r"^python3 (-m control hold .*)$", page, re.MULTILINE)
    done = subprocess.run([sys.executable, *command.split()], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.startswith("converged"), done.stderr
