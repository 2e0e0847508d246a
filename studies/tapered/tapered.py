"""Tapered fingers of elements of a straight one against the full-order model of the tapered finger, on like meshes."""

from __future__ import annotations

import tomllib
from typing import Any

import numpy as np

from rom.build import train_rod
from rom.dataset.snapshot_set import SnapshotSet
from rom.plane_check import check
from rom.rod.pressed_check import check_pressed
from rom.rod.rod import Rod
from studies import sets
from studies.parts import ROOT, Run
from studies.rods import plans

ROUND = ROOT / "scenes" / "silicone" / "round_pressed.toml"
TAPERS = {"square": (0.9, 0.7, 0.5), "circle": (0.7, 0.5)}
COUNT, SEED = 10, 5  # states
LENGTH, PLANE = 0.050, (0.001, 0.031)  # of the square finger, distances of its plane; of a longer one, longer [m]
LINES = 24


def straight(run: Run, section: str) -> Rod:
    """The finger that elements were trained on: the draft one, or the bundled round one on its first mesh alone."""
    if section == "square":
        return plans.rod(run, plans.LARGE)
    return train_rod(sets.training(sets.written(run.sets, "round pressed", ROUND.read_text())), {}, [])


def scene(finger: Rod, taper: float) -> dict[str, Any]:
    """The finger with a taper; tensions are those that its thinnest elements were trained with, cells like theirs."""
    table = {
        key: finger.scene[key] for key in ("name", "section", "geometry", "material", "tendons") if key in finger.scene
    }
    ratio = -np.log(taper) / (1 - taper) if taper != 1 else 1.0  # mean of 1 / size along the finger
    mesh = finger.elements.scene["mesh"]
    tendons = [one | {"tension": [0.0, one["tension"][1] * taper**2]} for one in table["tendons"]]
    cells = [round(mesh["cells"][0] * ratio), mesh["cells"][1]]
    geometry = table["geometry"] | {"taper": [taper]}
    return table | {"geometry": geometry, "tendons": tendons, "mesh": {"cells": cells, "order": mesh["order"]}}


def held_out(run: Run, name: str, table: dict[str, Any]) -> SnapshotSet:
    """Random states of a scene."""
    file = sets.written(run.folder, name, sets.as_toml(table))
    place = file.with_suffix("") / "held-out"
    sets.farm(2, file, place, "--random", str(COUNT), "--seed", str(SEED))
    return SnapshotSet(place)


def row(run: Run, section: str, taper: float) -> dict:
    """A finger of one taper: pressed on its plate by forces of all directions, and before a plane."""
    own = straight(run, section)
    table, longer = scene(own, taper), sum(own.scene["geometry"]["segments"]) / LENGTH
    load = {"load": {"force": own.force * taper**2}, "sampling": {"lines": LINES}}
    plane = table | {"obstacle": {"distance": [longer * one for one in PLANE], "method": "penalty"}}
    finger = own.assembled(tomllib.loads(sets.as_toml(plane)))
    before = check(finger, held_out(run, f"{section} plane {taper}", plane))
    under = check_pressed(finger, held_out(run, f"{section} pressed {taper}", table | load))
    return {
        "section": section,
        "taper": taper,
        "elements": len(finger.pieces[0]),
        "states": before["states"],
        "failed": before["failed"] + under["failed"],
        "wrong": before["touch"]["wrong_beyond_margin"],
        "tip": before["tip"],
        "force": before["contact_force"],
        "place_um": {key: 1e6 * under["place_m"][key] for key in ("median", "p95", "max")},
        "pressed_force": under["contact_force"],
        "covered": under["covered"],
    }


def measure(run: Run) -> list[dict]:
    """A row a section and taper."""
    return [
        run.once(f"{section} {taper}", row, run, section, taper) for section, every in TAPERS.items() for taper in every
    ]
