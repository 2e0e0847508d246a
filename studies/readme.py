"""Write what README and docs/demo.md show of a demo, and pictures: python3 studies/readme.py out/demo."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from control.export.page import write as write_page
from rom import TouchedSegment
from studies import report

BEGIN, END = "<!-- measured: written by `make readme` -->", "<!-- end -->"
CHROMIUM = (
    *("chromium", "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
    *("--hide-scrollbars", "--window-size=1180,700", "--virtual-time-budget=5000"),  # [pixels], [ms]
    *("--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update"),
)


def put(page: str, text: str) -> None:
    """Rewrite the measured block of a page."""
    file = ROOT / page
    before, rest = file.read_text().split(BEGIN)
    file.write_text(before + BEGIN + text + END + rest.split(END, 1)[1])


def photograph(picture: Path) -> None:
    """A picture of the page of the bundled finger, in Chromium."""
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "finger.html"
        write_page(TouchedSegment.load(), page)
        command = [*CHROMIUM, f"--user-data-dir={folder}/profile", f"--screenshot={picture}", page.as_uri()]
        subprocess.run(command, check=True, capture_output=True)


def main(folder: Path) -> None:
    """Rewrite README.md, docs/demo.md and their pictures."""
    numbers = json.loads((folder / "report.json").read_text())
    docs = ROOT / "docs"
    put("README.md", report.render("readme.md.j2", numbers))
    put("docs/demo.md", report.render("demo.md.j2", numbers))
    shutil.copyfile(folder / "s11.png", docs / "finger.png")
    photograph(docs / "page.png")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "out" / "demo"))
