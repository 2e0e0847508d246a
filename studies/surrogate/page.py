"""Write docs/surrogate.md from what surrogate.py, others.py, growth.py and two_meshes.py measured.

python3 studies/surrogate/page.py [OUT]    (out/surrogate by default)
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from studies.readme import table

MESHES = {"draft": "draft", "middle": "one segment, middle mesh", "two segments": "two segments"}


def percent(value: float) -> str:
    """For people."""
    return f"{100 * value:.0f} %" if value >= 0.1 else f"{100 * value:.2g} %"


def errors(found: dict) -> str:
    """Error on fresh states by scene."""
    header = ["scene", "contact states", "regimes", "fresh states", "displacement, median", "95 %"]
    header += ["contact force, median", "95 %", "largest", "wrong touch decisions"]
    rows = []
    for name, row in found["accuracy"].items():
        field, force = row["displacement"], row["contact_force"]
        rows.append(
            [
                MESHES[name],
                f"{row['contact_states']:,}",
                str(len(row["regimes"])),
                str(row["states"]),
                percent(field["median"]),
                percent(field["p95"]),
                *(percent(force[key]) for key in ("median", "p95", "max")),
                f"{row['touch']['wrong']} ({row['touch']['wrong_beyond_margin']} farther than 0.05 mm from touch)",
            ]
        )
    return table(header, rows)


def plain(found: dict) -> str:
    """Regimes beside plain forms, on the same states."""
    ours = found["accuracy"]["draft"]["contact_force"]
    rows = [
        [row["form"], str(row["terms"]), *(percent(row[key]) for key in ("median", "p95", "max"))]
        for row in found["plain"]
    ]
    terms = sum(count for name, count in found["accuracy"]["draft"]["terms"].items() if name.startswith("regime"))
    rows.append(
        ["one form a regime, over (F, s)", str(terms), *(percent(ours[key]) for key in ("median", "p95", "max"))]
    )
    return table(["contact force by", "terms", "median", "95 %", "largest"], rows)


def said(found: dict) -> str:
    """What the surrogate says of its error."""
    rows = [
        [
            MESHES[name],
            quantity.replace("_", " "),
            percent(one["covered"]),
            *(f"{ratio:.1f}" for ratio in one["ratios"]),
        ]
        for name, row in found["accuracy"].items()
        for quantity, one in row["said"].items()
    ]
    return table(["scene", "error of", "within what is said", "said over true, smaller half", "larger half"], rows)


def speed(found: dict) -> str:
    """Times on the machine that wrote this."""
    one, field = found["speed"], found["field"]
    call, batch = one["value_and_jacobian"], one["batch"]
    return f"""One core, from Python, on the machine that wrote this: tip, contact force, touch distance and their derivatives in {call["p50_us"]:.1f} us (median;
{call["p99_us"]:.1f} us at the 99th percentile); {batch["count"]:,} points at once in {batch["us_each"]:.2f} us each; the model is loaded in {1e3 * one["load_seconds"]:.0f} ms and its file has
{one["bytes"] / 1e6:.1f} MB, most of it the displacement field. Value and gradient of a single form within compiled code, against terms and axes:

{table(["terms (3 axes)", *(str(row["terms"]) for row in found["cost"]["terms"])], [["us", *(f"{row['us']:.2f}" for row in found["cost"]["terms"])]])}

{table(["axes (200 terms)", *(str(row["axes"]) for row in found["cost"]["axes"])], [["us", *(f"{row['us']:.2f}" for row in found["cost"]["axes"])]])}

The displacement of all nodes of the paper's mesh ({field["unknowns"]:,} unknowns, {field["components"]} principal components) takes {field["in_contact"]["p50_us"]:.0f} us in contact (median;
{field["in_contact"]["p99_us"]:.0f} us at the 99th percentile); that model is loaded in {1e3 * field["load_seconds"]:.0f} ms ({field["bytes"] / 1e6:.0f} MB)."""


def beside(rows: list[dict]) -> str:
    """Other packages."""
    listed = [
        [
            row["package"],
            row["method"],
            *(percent(row[key]) for key in ("median", "p95", "max")),
            f"{row['p50_us']:.0f}",
            f"{row['p99_us']:.0f}",
            f"{row['bytes'] / 1e3:,.0f}",
        ]
        for row in rows
    ]
    header = ["package", "method", "contact force, median", "95 %", "largest", "us a query, median", "99 %", "kB"]
    return table(header, listed)


def growth(rows: list[dict]) -> str:
    """What more parameters cost."""
    header = ["parameters", "tendons", "states", "a grid of 9 nodes a tension", "regimes", "terms for 1 %"]
    header += ["terms, all forms", "kB", "us a query, median", "contact force, median", "95 %", "largest"]
    header += ["errors within what is said"]
    listed = [
        [
            str(row["parameters"]),
            ", ".join(row["tendons"]),
            f"{row['states']:,}",
            f"{row['grid_states']:,}",
            str(row["regimes"]),
            str(row["terms"] or "more"),
            str(row["all_terms"]),
            f"{row['bytes'] / 1e3:,.0f}",
            f"{row['query']['p50_us']:.0f}",
            *(percent(row["contact_force"][key]) for key in ("median", "p95", "max")),
            percent(row["said"]["covered"]),
        ]
        for row in rows
    ]
    return table(header, listed)


def two_meshes(found: dict) -> str:
    """Surrogates of one mesh and of two."""
    header = [
        "trained on",
        "fine states",
        "against its own mesh: median",
        "95 %",
        "against a third, finer mesh: median",
    ]
    listed = [
        [row["kind"], f"{row['states']:,}" if "draft" not in row["kind"] else "0"]
        + [percent(row["surrogate"][key]) for key in ("median", "p95")]
        + [percent(row["total"]["median"])]
        for row in found["rows"]
    ]
    return table(header, listed)


def page(found: dict, others: list[dict], grown: list[dict], both: dict) -> str:
    """The whole page."""
    headline, meshes = both["headline"], both["mesh"]
    states = next(row for row in both["rows"] if row["lines"] == headline["lines"])["states"]
    whole = next(row for row in both["rows"] if row["kind"].endswith("all its states"))["states"]
    return f"""# The surrogate

Numbers written by `make surrogate` from `studies/surrogate/surrogate.py`, `others.py`, `growth.py` and `two_meshes.py`.

## Why contact regimes

A rigid plate touches a plane with a corner, an edge or a face. While what carries stays the same, everything depends smoothly on tensions and
distance; where it changes, everything has a kink, and no product of one-dimensional functions follows a kink on a curved surface. The
full-order model says of every state what carries. In each such regime the response is fitted by a polynomial to the states' values and
sensitivities, in coordinates that begin where the regime's corner touches, and separated; conditions that are smooth, too, say where
the regime ends: a corner's tilt, the force on the far end of an edge, a gap. A line of states gets more where its regime changes, and small
regimes get lines of their own. The same states without that, draft finger:

{plain(found)}

## Error on fresh states

Uniform over the whole box, against the full-order model on the same mesh; displacement as the relative 2-norm of the field, contact force where it is
above 0.1 N.

{errors(found)}

## What it says of its own error

Of states that touch: how many true errors are within what is said, and what is said (median) over what 95 % of true errors keep, for the half of
states for which least is said, and the other half. Other fresh states scaled what is said.

{said(found)}

## More parameters

The finger of `scenes/four_tendons.toml` on 12 x 9 x 9 cells a segment, pulled by one to four tendons; lines of states at scattered tensions, 40 a
tension, so that states grow with the number of parameters and not with its power. Terms are those of the regime with the most states.

{growth(grown)}

## Two meshes

What a finer mesh changes is small and smooth, and few states tell it: `rom build FINE/ --coarse COARSE/`. Fine states should be enough: with a few lines only,
a correction can be worse than none, and the errors of such a model want `--held-out`. Draft mesh (20 x 5 x 5 cells,
{both["coarse_states"]:,} states) corrected by states on the middle mesh (40 x 7 x 7); contact force above 0.1 N. With {states} fine states ({states / whole:.2f} of the {whole} of a
training set on the fine mesh alone) the displacement's error is {percent(headline["displacement"]["median"])} (median; {percent(headline["displacement"]["p95"])} at 95 %), and
{percent(headline["said_unscaled"]["contact_force"]["covered"])} of the errors of the contact force are within what the model says; {percent(headline["said"]["contact_force"]["covered"])} where {headline["scaling_states"]} more fine states, held out, have scaled it
(`--held-out`). The meshes themselves err by {percent(meshes["draft"]["median"])} and {percent(meshes["middle"]["median"])} (median) against 80 x 11 x 11 cells: a surrogate far better than its mesh is waste, and the picture,
after figure 9 of the paper, says how many states are enough.

{two_meshes(both)}

![errors of mesh and surrogate](two_meshes.png)

## Speed

{speed(found)}

## Beside other packages

Tip and contact force of the draft finger from the same contact states, one process; TensorLy's decomposition is of the grid in contact-aligned
coordinates, with splines along its axes. This project's query includes the derivatives, the touch distance and the decision of the regime.

{beside(others)}
"""


def main(folder: Path) -> None:
    """Rewrite docs/surrogate.md."""
    found = json.loads((folder / "surrogate.json").read_text())
    others = json.loads((folder / "others.json").read_text())
    grown = json.loads((folder / "growth.json").read_text())
    both = json.loads((folder / "two_meshes.json").read_text())
    (ROOT / "docs" / "surrogate.md").write_text(page(found, others, grown, both))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "out" / "surrogate"))
