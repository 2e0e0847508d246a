"""Write docs/solver.md from what the studies of the solver measured: python3 studies/solver/page.py out/solver."""

from __future__ import annotations

import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from studies.readme import table

Rows = list[dict]


def short(value: float | None, digits: int = 3) -> str:
    """A number for a table."""
    return "-" if value is None else f"{value:,}" if isinstance(value, int) else f"{value:.{digits}g}"


def against(rows: Rows, name: str, reference: dict) -> list[str]:
    """Times of a column as multiples of one row's: seconds depend on the machine, ratios less."""
    return [f"{row[name] / reference[name]:.2f}" if name in row else "-" for row in rows]


def columns(header: dict[str, list[str]]) -> str:
    """A table given by its columns."""
    return table(list(header), [list(row) for row in zip(*header.values(), strict=True)])


def speed(found: dict) -> str:
    """Factorisations, plain Newton beside it, growth with the unknowns."""
    rest, plain = found["from_rest"], found["against_plain_newton"]
    lines = columns(
        {
            "tensions [N]": [", ".join(short(tension) for tension in line["tensions"]) for line in found["lines"]],
            "factorisations": [short(line["factorisations"]) for line in found["lines"]],
            "contact force at the end [N]": [short(line["contact_forces"][-1]) for line in found["lines"]],
        }
    )
    states = len(found["lines"][0]["distances"])
    sizes = found["sizes"]
    solved = [row for row in sizes if "failed" not in row]
    grown = columns(
        {
            "cells": [" x ".join(map(str, [row["cells"][0], row["cells"][1], row["cells"][1]])) for row in sizes],
            "unknowns": [short(row["unknowns"]) for row in sizes],
            "factorisations": [short(row.get("factorisations")) for row in sizes],
            "steps": [short(row.get("steps")) for row in sizes],
            "time, whole": against(sizes, "seconds", solved[0]),
            "time, per factorisation": ["-" if "failed" in row else _each(row, solved[0]) for row in sizes],
        }
    )
    return f"""## Speed

Scene *{found["scene"]}*, {rest["unknowns"]:,} unknowns. From rest to 100 N on one tendon: **{rest["factorisations"]} factorisations** in
{rest["steps"]} steps, those of the predictors included.

Contact lines of {states} states each, every state starting from the last one: **{found["factorisations_per_contact_state"]:.2f} factorisations a state**.

{lines}

The line at {plain["tensions"][0]:g} and {plain["tensions"][1]:g} N, the way from rest included, against the same {states} states each solved from rest by
plain Newton (PETSc's SNES, full steps, MUMPS LU, increments of 25 N, the plane in place), in one run: **{plain["times_faster"]:.1f} times less wall
time**. Plain Newton needed {plain["plain_factorisations"]} factorisations and did not converge in {plain["plain_not_converged"]} of the {states} states; where it did,
the contact forces differ by {short(plain["largest_difference"])} at most, and a state took {plain["times_faster_where_plain_converged"]:.1f} times less wall time.

From rest to 100 N on finer and finer meshes; times are multiples of the first row's:

{grown}
"""


def _each(row: dict, first: dict) -> str:
    return f"{row['seconds'] / row['factorisations'] / (first['seconds'] / first['factorisations']):.2f}"


def choices(found: dict) -> str:
    """What the solver was chosen from."""
    factors = found["factorisations"]
    chosen = next(row for row in factors if row["factorisation"] == "LDL^T" and row["ordering"] == "automatic")
    factorised = columns(
        {
            "factorisation": [row["factorisation"] for row in factors],
            "ordering": [row["ordering"] for row in factors],
            "first, with analysis": against(factors, "first_seconds", chosen),
            "again": against(factors, "seconds", chosen),
            "solve": against(factors, "solve_seconds", chosen),
            "entries": [short(row["entries"]) for row in factors],
        }
    )
    flags = found["flags"]
    usual = next(row for row in flags if row["flags"] == "-O2 -g0")
    compiled = columns(
        {
            "flags": [f"`{row['flags']}`" for row in flags],
            "building the model": against(flags, "build_seconds", usual),
            "tangent": against(flags, "tangent_seconds", usual),
            "residual": against(flags, "residual_seconds", usual),
            "residual differs": [short(row["residual_differs"], 1) for row in flags],
        }
    )
    degrees = found["quadrature"]
    first = {row["order"]: row for row in degrees if row.get("chosen")}
    integrated = columns(
        {
            "order": [str(row["order"]) for row in degrees],
            "degree": [f"**{row['degree']}**" if row.get("chosen") else str(row["degree"]) for row in degrees],
            "tangent, time": [
                f"{row['tangent_seconds'] / first[row['order']]['tangent_seconds']:.2f}" if "tip" in row else "failed"
                for row in degrees
            ],
            "factorisations": [short(row.get("factorisations")) for row in degrees],
            "tip error [mm]": [_millimetres(row) for row in degrees],
            "contact force error [%]": [_percent(row) for row in degrees],
        }
    )
    orders = found["orders"]
    elements = columns(
        {
            "order": [str(row["order"]) for row in orders],
            "cells": [" x ".join(map(str, row["cells"])) for row in orders],
            "unknowns": [short(row["unknowns"]) for row in orders],
            "factorisations": [short(row["factorisations"]) for row in orders],
            "time": against(orders, "seconds", orders[0]),
            "tip error [mm]": [_millimetres(row) for row in orders],
            "contact force error [%]": [_percent(row) for row in orders],
        }
    )
    return f"""## Choices

Times are multiples of the chosen row's, taken in one run.

**Factorisation** of the tangent of a bent finger, scene *{found["scene"]}*. The project takes LDL^T and MUMPS' automatic
ordering. Orderings that the MUMPS at hand was built without are left out.

{factorised}

**Compiler flags** of the forms, each with a cache of its own. The project leaves DOLFINx's `-O2 -g0`: machines
of a cluster may share a cache, and code made for one of them (`native`) ends another's job; `-Ofast` may also assume that no number is
NaN. Who trains for days on machines of one kind can set faster flags in `dolfinx_jit_options.json`.

{compiled}

**Quadrature degree** in the volume (bold: the project's); errors against the highest degree of the same order, F1 = 60 N, d = 5 mm.

{integrated}

**Element order**: the same state on half the finger; errors against order 2 on a finer mesh.

{elements}
"""


def _millimetres(row: dict) -> str:
    return short(1e3 * row["tip_error"], 2) if "tip_error" in row else "-"


def _percent(row: dict) -> str:
    return short(100 * row["contact_force_error"], 2) if "contact_force_error" in row else "-"


def scenes(found: dict) -> str:
    """What each kind of scene costs."""
    rows = found["scenes"]
    return f"""## What each kind of scene costs

On one mesh a segment; times of one Newton iteration (residual, tangent, factorisation, solve) as multiples of the first row's.

{
        columns(
            {
                "scene": [row["scene"] for row in rows],
                "parameters": [str(row["parameters"]) for row in rows],
                "unknowns": [short(row["unknowns"]) for row in rows],
                "compiled forms": [str(row["forms"]) for row in rows],
                "assembly": against(rows, "assembly_seconds", rows[0]),
                "factorisation": against(rows, "factorise_seconds", rows[0]),
                "iteration": against(rows, "iteration_seconds", rows[0]),
            }
        )
    }
"""


def main(folder: Path) -> None:
    """Write the page."""
    read = {name: json.loads((folder / f"{name}.json").read_text()) for name in ("solver", "choices", "scenes")}
    page = f"""# The full-order solver, measured

Written by `make solver` from `studies/solver/solver.py`, `studies/solver/choices.py` and `studies/solver/scenes.py`, on one core.

{speed(read["solver"])}
{choices(read["choices"])}
{scenes(read["scenes"])}"""
    (ROOT / "docs" / "solver.md").write_text(page)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "out" / "solver"))
