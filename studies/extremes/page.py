"""Write docs/extremes.md from what extremes.py found.

python3 studies/extremes/page.py [OUT]    (out/extremes by default)
"""

from __future__ import annotations

import json
import sys
from itertools import groupby
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from studies.readme import table

INTRO = """# The ends of every range

Written by `studies/extremes/page.py` from what `studies/extremes/extremes.py` found. Whatever is asked at the end of a range comes out right, within a stated bound of a
reference that does not come from the same computation, or is refused with its reason. There is no third outcome: {rows} extremes, {right}
right, {refused} refused.
"""


def main() -> None:
    """Write the page."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "out" / "extremes")
    rows = json.loads((folder / "extremes.json").read_text())["rows"]
    counts = {outcome: sum(row["outcome"] == outcome for row in rows) for outcome in ("right", "refused")}
    text = INTRO.format(rows=len(rows), **counts)
    for part, listed in groupby(rows, key=lambda row: row["part"]):
        text += f"\n## {part[0].upper()}{part[1:]}\n\n"
        cells = []
        for row in listed:
            error = "" if row["error"] is None else f"{row['error']:.2g}"
            bound = "" if row["bound"] is None else f"{row['bound']:.2g}"
            cells.append(
                [row["extreme"], row["case"], row["outcome"], error, bound, row["reference"].replace("|", "/")]
            )
        header = ["what", "how far", "outcome", "relative error", "bound", "against, or why"]
        text += table(header, cells) + "\n"
    (ROOT / "docs" / "extremes.md").write_text(text)


if __name__ == "__main__":
    main()
