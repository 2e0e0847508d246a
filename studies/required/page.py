"""Write docs/required.md from what required.py measured.

python3 studies/required/page.py [OUT]    (out/required by default)
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from studies.readme import table

INTRO = """# Only what a scene requires

Written by `make required` from `studies/required/required.py`: one mesh of 12 x 9 x 9 cells a segment, 16 lines of states a tension. Leave a table, a
tendon or a quantity out of a scene and it is neither modelled, nor sampled, nor stored; `tests/fingerfem/snapshots/test_required.py` counts it in
unknowns, compiled forms, axes and datasets. Core-seconds are of the machine that wrote this, and comparable within the table.

"""


CLOSE = """
With an obstacle, a free finger's {free:,.0f} kB become {contact:,.0f}, mostly the field in every contact regime; a scene that stores tip and
contact force alone needs {forces:,.0f} kB, and trains as long, since the full-order model has to find the same states.
"""


def sizes(rows: list[dict]) -> dict[str, float]:
    """Of three models [kB]."""
    kilobytes = {row["scene"]: row["bytes"] / 1000 for row in rows}
    names = {"free": "free, spatial", "contact": "contact, spatial"}
    names["forces"] = "contact, spatial, tip and contact force only"
    return {key: kilobytes[name] for key, name in names.items()}


def main() -> None:
    """Write the page."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "out" / "required")
    rows = json.loads((folder / "required.json").read_text())["scenes"]
    header = [
        "scene",
        "parameters",
        "unknowns",
        "compiled forms",
        "quantities a state",
        "states",
        "training [core-seconds]",
    ]
    header += ["datasets", "model [kB]", "terms", "query [us]"]
    cells = [
        [
            row["scene"],
            *(f"{row[key]:,}" for key in ("parameters", "unknowns", "forms", "quantities", "states")),
            f"{row['core_seconds']:.0f}",
            str(row["datasets"]),
            f"{row['bytes'] / 1000:,.0f}",
            f"{row['terms']:,}",
            f"{row['query_us']:.1f}",
        ]
        for row in rows
    ]
    (ROOT / "docs" / "required.md").write_text(INTRO + table(header, cells) + "\n" + CLOSE.format(**sizes(rows)))


if __name__ == "__main__":
    main()
