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


def table(header: list[str], rows: list[list[str]]) -> str:
    """A Markdown table."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def put(begin: str, text: str, page: str = "README.md") -> None:
    """Rewrite the block of a page that starts with a mark, if it has one."""
    file = ROOT / page
    if begin in file.read_text():
        before, rest = file.read_text().split(begin)
        file.write_text(before + begin + text + END + rest.split(END, 1)[1])


def summary(numbers: dict) -> str:
    """README's block: one table, and the speed beside the paper's."""
    sweep, found = numbers["campaign"], numbers["errors"]
    return f"""
The demo's finger is compared with {found["states"]} held-out full-order states on the fine mesh; contact forces count above 0.1 N. Answers left out, as `inside` is false: {found["marked"]}.
Touch is decided correctly in {found["touch"]["count"] - found["touch"]["wrong"]} states.

{table(report.ERROR_HEADER, [row for row in report.error_rows(numbers) if row[0] != "touch distance"])}

In the paper's sweep of {sweep["starts"]:,} holds, one takes {sweep["mean_us"]:.0f} µs on average and {sweep["p99_us"]:.0f} µs at the 99th percentile. The paper reports
7,160 µs on average and 31,000 µs at most, on another machine.
"""


def measured(numbers: dict) -> str:
    """The block of docs/demo.md."""
    coarse, fine, sweep, held_out = (numbers[name] for name in ("coarse", "fine", "campaign", "heldout"))
    found = numbers["errors"]
    touch = found["touch"]
    return f"""
The demo's finger (`scenes/demo/`) is assembled from {len(numbers["elements"])} rod elements ({", ".join(numbers["elements"])}). They were trained on {fine["states"]} full-order
states on {report.mesh_name(numbers["meshes"]["fine"])} ({numbers["unknowns"]["fine"]:,} unknowns; {fine["newton_iterations"] / fine["states"]:.1f} factorisations per state). Each began at the same state on
{report.mesh_name(numbers["meshes"]["coarse"])} ({coarse["newton_iterations"] / coarse["states"]:.1f} per state); {coarse["failed"] + fine["failed"]} failed. Contact is solved for online. The table compares the finger with {found["states"]}
held-out states of the fine mesh before a plane ({held_out["newton_iterations"] / held_out["states"]:.1f} factorisations per state), contact forces above 0.1 N. Marked answers,
whose force is beyond the trained range, are not counted: {found["marked"]}.

{table(report.ERROR_HEADER, report.error_rows(numbers))}

Touch is decided correctly in {touch["count"] - touch["wrong"]} of {touch["count"]} states.

![The demo's finger, coloured by axial stress, in four load cases](finger.png)

Contact forces held at {numbers["grasp"]["target"]:g} N, fed to the full-order model on a third mesh, {report.mesh_name(numbers["scene"]["mesh"])}; the grasp's fingers find d and correct their tensions by the contact force that they feel:

{table(report.HOLD_HEADER, report.hold_rows(numbers))}

The authors' sweep of {sweep["starts"]:,} holds: {sweep["converged"]:,} converged, {sweep["unreachable"]:,} unreachable and flagged,
{sweep["failed"]} without an answer (`out_of_domain`: beyond the trained force), {sweep["out_of_limits"]} outside the limits. A solve takes {sweep["mean_us"]:.0f} µs on average and {sweep["p99_us"]:.0f} µs at the 99th percentile.
The authors report 7,160 µs on average and 31,000 µs at most, on another machine.
"""


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
    put(BEGIN, summary(numbers))
    put(BEGIN, measured(numbers), "docs/demo.md")
    shutil.copyfile(folder / "s11.png", docs / "finger.png")
    photograph(docs / "page.png")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "out" / "demo"))
