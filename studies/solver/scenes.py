"""What each kind of scene costs, measured on one mesh: unknowns, compiled forms, time of one Newton iteration.

python3 studies/solver/scenes.py [OUT] [--quick]
    prints a table, writes OUT/scenes.json (out/solver by default); one core
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import sys
from pathlib import Path
from typing import Any

from dolfinx import fem

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from fingerfem import FingerModel, load_scene
from fingerfem.scene.scene import Scene
from studies.solver.choices import timed
from studies.solver.solver import SCENES, say


def kinds() -> dict[str, dict[str, Any]]:
    """Scenes by what they name."""
    one, two, four = (load_scene(SCENES / f"{name}.toml") for name in ("one_segment", "two_segments", "four_tendons"))
    table = one.model_dump()
    planar, alone = {"tendons": table["tendons"][:1]}, {"obstacle": None}
    straight = [table["tendons"][0] | {"path": "straight"}]
    nearly = {
        "law": "neo-hookean",
        "C1": 1.9e6,
        "D1": 3 * (1 - 2 * 0.4999) / (2 * 1.9e6 * 1.4999),
    }  # Poisson's ratio 0.4999
    return {
        "free, planar": table | planar | alone,
        "free, spatial": table | alone,
        "free, planar, straight tendon": table | alone | {"tendons": straight},
        "free, planar, nearly incompressible": table | planar | alone | {"material": nearly},
        "contact, planar": table | planar,
        "contact, spatial": table,
        "contact, planar, Nitsche": table | planar | {"obstacle": table["obstacle"] | {"method": "nitsche"}},
        "two segments, contact, planar": two.model_dump(),
        "two segments, four tensions, contact": four.model_dump(),
    }


def count(forms: Any) -> int:
    """Compiled forms in what a model holds."""
    if isinstance(forms, fem.Form):
        return 1
    if isinstance(forms, list):
        return sum(map(count, forms))
    if dataclasses.is_dataclass(forms):
        return sum(count(getattr(forms, field.name)) for field in dataclasses.fields(forms))
    return 0


def cost(name: str, scene: Scene) -> dict:
    """What one iteration of a scene costs, at rest: assembly of residual and tangent, factorisation, solve."""
    model = FingerModel(scene)
    newton = model.continuation.newton
    linearisation = newton.linearise()
    right, _ = model.problem.residual()
    assembly = timed(lambda: model.problem.residual()[0].destroy()) + timed(model.problem.tangent)
    seconds = {
        "assembly_seconds": assembly,
        "solve_seconds": timed(lambda: linearisation.solve(right.copy())),
        "factorise_seconds": timed(newton.linearise) - timed(model.problem.tangent),
    }
    return {
        "scene": name,
        "parameters": len(scene.parameters),
        "unknowns": model.problem.unknowns,
        "forms": count(model.problem.forms),
        **seconds,
        "iteration_seconds": sum(seconds.values()),
    }


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", nargs="?", default="out/solver")
    parser.add_argument("--quick", action="store_true", help="a coarser mesh, and no Nitsche, whose forms take long")
    options = parser.parse_args()
    rows = []
    for name, table in kinds().items():
        if options.quick and "Nitsche" in name:
            continue
        table["mesh"] = {"cells": [20 if options.quick else 60, 10], "order": 1}  # of each segment
        rows.append(cost(name, Scene.model_validate(table)))
        say(rows[-1])
    folder = Path(options.out)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scenes.json").write_text(json.dumps({"scenes": rows}, indent=1))


if __name__ == "__main__":
    main()
