"""The fingers of the study: rods of trained elements, and their full-order scenes on the elements' mesh."""

from __future__ import annotations

import tomllib
from typing import Any

from rom import Rod, TouchedSegment
from rom.build import train_rod
from rom.dataset.sections.section import top
from rom.rod.objects.shapes import facing_plane
from studies import sets
from studies.parts import ROOT, Run

Table = dict[str, Any]

DENSITY = 1070.0  # of the rubber [kg/m^3]
DISTANCES = (0.001, 0.06)  # of the plane [m]
BUNDLED = ROOT / "scenes" / "silicone" / "square_pressed.toml"
OFFSET, STRONGEST = 0.0065, 6.0  # of round fingers' two tendons, towards y and z [m]; their largest tension [N]
SAMPLING = {"lines": 8, "wrenches": 4}  # of round fingers
ROUND: dict[str, Table] = {
    "ring": {
        "section": {"shape": "ring", "diameter": 0.020, "bore": 0.010},
        "geometry": {"segments": [0.060], "plate": 0.002, "channel": 0.003},
        "mesh": {"cells": [6, 7], "order": 2},  # curved, so that the plate rolls
    },
    "circle": {
        "section": {"shape": "circle", "diameter": 0.020},
        "geometry": {"segments": [0.060], "plate": 0.002, "channel": 0.0055},  # fewer cells across than by 3 mm
        "mesh": {"cells": [6, 4], "order": 2},
    },
}
CELLS, PLATES = 11, (1, 2, 2, 1)  # of two segments: cells along the rubber of each; where the square's tendons end


def trained(run: Run, name: str) -> Rod:
    """A finger, of elements that were trained without states of a finer mesh."""
    if name == "two segments":
        return two_segments(trained(run, "square"))
    file = sets.written(run.sets, f"motion {name}", sets.as_toml(training(name)))
    kept = file.with_suffix(".h5")
    if not kept.exists():
        train_rod(sets.training(file), {}, []).save(kept)
    return Rod.load(kept)


def training(name: str) -> Table:
    """The scene of the training: of the bundled square finger, or of a round one."""
    table = tomllib.loads(BUNDLED.read_text())
    if name == "square":
        return table
    up, right = (one | {"tension": [0.0, STRONGEST]} for one in table["tendons"][:2])
    tendons = [up | {"offset": [OFFSET, 0.0]}, right | {"offset": [0.0, OFFSET]}]
    return table | ROUND[name] | {"sampling": SAMPLING, "name": name, "tendons": tendons}


def cell(scene: Table) -> float:
    """Length of a cell of rubber [m]; one cell more is the plate's."""
    geometry, (along, _) = scene["geometry"], scene["mesh"]["cells"]
    return float((max(geometry["segments"]) - geometry["plate"]) / (along - 1))


def two_segments(rod: Rod) -> Rod:
    """A finger of two segments, of the elements of one."""
    scene = rod.elements.scene
    length = CELLS * cell(scene) + scene["geometry"]["plate"]
    pulled = zip(scene["tendons"], PLATES, strict=True)
    return rod.assembled(
        {
            "name": "two segments",
            "geometry": scene["geometry"] | {"segments": [length, length]},
            "material": scene["material"],
            "tendons": [one | {"segment": plate} for one, plate in pulled],
        }
    )


def table(rod: Rod, prony: list[list[float]] | None = None, before_plane: bool = False) -> Table:
    """The full-order scene of a finger, with cells as long as the elements'."""
    scene, (_, across) = rod.elements.scene, rod.elements.scene["mesh"]["cells"]
    found = {name: one for name, one in rod.scene.items() if name not in ("load", "sampling", "coarse") and one}
    rubber = max(found["geometry"]["segments"]) - found["geometry"]["plate"]
    found["mesh"] = scene["mesh"] | {"cells": [round(rubber / cell(scene)) + 1, across]}
    found["density"] = {"rubber": DENSITY}
    if prony:
        found["material"] = found["material"] | {"prony": prony}
    if before_plane:
        found["obstacle"] = {"distance": list(DISTANCES), "method": "penalty"}
    return found


def touching(rod: Rod, prony: list[list[float]] | None = None) -> TouchedSegment:
    """The finger before the plane, perhaps of rubber with branches."""
    material = rod.scene["material"] | ({"prony": prony} if prony else {})
    own = Rod(elements=rod.elements, scene=rod.scene | {"material": material})
    return TouchedSegment(rod=own, obstacle=facing_plane(2 * top(rod.scene), DISTANCES))
