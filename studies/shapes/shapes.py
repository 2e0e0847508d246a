"""Fingers of other sections: what training costs, and how well elements predict states held out from it."""

from __future__ import annotations

import tomllib
from typing import Any

import numpy as np

from rom.build import train_rod
from rom.dataset.sections.section import area
from rom.elements.samples.section_states import read_section_states
from rom.rod.pressed_check import check_pressed
from studies import sets
from studies.parts import Run

SECTIONS: dict[str, dict[str, Any]] = {
    "square": {"shape": "square", "side": 0.020},
    "circle": {"shape": "circle", "diameter": 0.020},
    "ring": {"shape": "ring", "diameter": 0.020, "bore": 0.006},
    "rectangle": {"shape": "rectangle", "height": 0.020, "width": 0.014},
}
CHAMBERED = "square, two chambers"
LINES, COUNT = 12, 20
MORE_LINES = 48  # of the one with chambers, which has three loads
STRESS, PRESSED = 4e4, 0.1  # largest tension over the section's area [Pa]; largest force on the plate over that [-]


def scene(name: str) -> dict[str, Any]:
    """The finger of a section: 60 mm of silicone with two tendons; or that of a file, with one tendon and chambers."""
    if name == CHAMBERED:
        table = tomllib.loads((sets.ROOT / "scenes" / "pressed_chambers.toml").read_text())
        return table | {"sampling": table["sampling"] | {"lines": MORE_LINES, "wrenches": 2}}
    tension = round(STRESS * area({"section": SECTIONS[name]}), 2)
    tendons = [
        {"name": f"F{k}", "offset": [y, 0.0], "segment": 1, "tension": [0.0, tension]}
        for k, y in enumerate((0.006, -0.006))
    ]
    return {
        "name": name,
        "section": SECTIONS[name],
        "geometry": {"segments": [0.060], "plate": 0.002, "channel": 0.004},
        "material": {"law": "yeoh", "C1": 9.2e4, "C2": 9.1e3, "D1": 2.2e-8},
        "tendons": tendons,
        "load": {"force": PRESSED * tension, "friction_angle": 0.6},
        "mesh": {"cells": [16, 5]},
        "sampling": {"lines": LINES, "wrenches": 2},
    }


def row(run: Run, name: str) -> dict[str, Any]:
    """A section: cost of its states, and errors of its elements in held-out ones."""
    file = sets.written(run.sets, f"shape {name}", sets.as_toml(scene(name)))
    training = sets.training(file)
    held_out = sets.held_out(file, COUNT)
    found = check_pressed(train_rod(training, {}, []), held_out)
    states = read_section_states(held_out)
    way = np.linalg.norm(states.plate.places - [states.length, 0.0, 0.0], axis=1)
    unknowns = 3 * len(training.nodes)
    return {
        "section": name,
        "unknowns": unknowns,
        "failed": len(training.failures) + found["failed"],
        "iterations": training.iterations / training.states,
        "seconds": training.core_seconds / training.states,
        "microseconds": 1e6 * training.core_seconds / training.iterations / unknowns,
        "place": {key: found["place_m"][key] / float(np.median(way)) for key in ("median", "p95", "max")},
        "force": found["contact_force"],
        "covered": found["covered"],
    }


def measure(run: Run) -> list[dict[str, Any]]:
    """A row a section."""
    return [run.once(name, row, run, name) for name in (*SECTIONS, CHAMBERED)]
