"""Write README's measured numbers and picture from a demo's report: python3 studies/readme.py out/demo."""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from studies import report

BEGIN, END = "<!-- measured: written by `make readme` -->", "<!-- end -->"


def table(header: list[str], rows: list[list[str]]) -> str:
    """A Markdown table."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def put(begin: str, text: str) -> None:
    """Rewrite README's block that starts with a mark."""
    readme = ROOT / "README.md"
    before, rest = readme.read_text().split(begin)
    after = rest.split(END, 1)[1]
    readme.write_text(before + begin + text + END + after)


def measured(numbers: dict) -> str:
    """The block between the marks."""
    coarse, fine, sweep, held_out = (numbers[name] for name in ("coarse", "fine", "campaign", "heldout"))
    both = numbers["errors"]["both"]
    touch = both["touch"]
    return f"""
The demo's finger (`scenes/demo/`): the map of its segment, from {coarse["states"]} full-order states on {report.mesh_name(numbers["meshes"]["coarse"])}
({coarse["newton_iterations"] / coarse["states"]:.1f} factorisations per state) and {fine["states"]} on {report.mesh_name(numbers["meshes"]["fine"])} ({numbers["unknowns"]["fine"]:,} unknowns; {fine["newton_iterations"] / fine["states"]:.1f} per state, as they
begin at the coarse ones), {coarse["failed"] + fine["failed"]} failed; contact is solved for online. Against {both["states"]} held-out states of the fine mesh before a plane,
which begin at the same on the coarse one ({held_out["newton_iterations"] / held_out["states"]:.1f} per state); {both["marked"]} of the answers are marked, as rubber touches or the force is beyond what was trained, and not counted.
Contact forces above 0.1 N:

{table(report.ERROR_HEADER, report.error_rows(numbers))}

Touch decided correctly in {touch["count"] - touch["wrong"]} of {touch["count"]} states. Contact forces held at
{numbers["grasp"]["target"]:g} N, fed to the full-order model on a third mesh, {report.mesh_name(numbers["scene"]["mesh"])}; the grasp's fingers find d themselves and correct by what they feel:

{table(report.HOLD_HEADER, report.hold_rows(numbers))}

The authors' sweep of {sweep["starts"]:,} holds: {sweep["converged"]:,} converged, {sweep["unreachable"]:,} unreachable and flagged,
{sweep["failed"]} without an answer (`out_of_domain`: so near that rubber may touch the plane, too), {sweep["out_of_limits"]} outside the limits; {sweep["mean_us"]:.0f} µs per solve on average and {sweep["p99_us"]:.0f} µs at the 99th percentile
on the machine that measured this (the authors report 7,160 µs and 31,000 µs at worst on theirs).
"""


def main(folder: Path) -> None:
    """Rewrite README.md and docs/finger.png."""
    numbers = json.loads((folder / "report.json").read_text())
    put(BEGIN, measured(numbers))
    (ROOT / "docs").mkdir(exist_ok=True)
    shutil.copyfile(folder / "s11.png", ROOT / "docs" / "finger.png")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "out" / "demo"))
