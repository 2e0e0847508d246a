"""Tapered fingers of elements of a straight one against the full-order model of the tapered finger, on like meshes."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from rom.dataset.snapshot_set import SnapshotSet
from rom.held_out import check
from rom.rod.check import check_pressed
from rom.rod.rod import Rod
from studies import sets
from studies.parts import Run
from studies.rods import plans
from studies.rods.plans import Plan

TAPERS, COUNT = (1.0, 0.9, 0.7, 0.5), 20
PLANE = {"distance": [0.001, 0.031], "method": "penalty"}
PLAN, SEED = Plan(15.0, 16, COUNT), 5


def scene(finger: Rod, taper: float) -> dict[str, Any]:
    """The finger with a taper; tensions are those that its thinnest elements were trained with, cells like theirs."""
    table = {key: finger.scene[key] for key in ("name", "geometry", "material", "tendons")}
    ratio = -np.log(taper) / (1 - taper) if taper != 1 else 1.0  # mean of 1 / size along the finger
    along, across = finger.elements.scene["mesh"]["cells"]
    tendons = [one | {"tension": [0.0, one["tension"][1] * taper**2]} for one in table["tendons"]]
    mesh = {"cells": [round(along * ratio), across], "order": finger.elements.scene["mesh"]["order"]}
    return table | {"geometry": table["geometry"] | {"taper": [taper]}, "tendons": tendons, "mesh": mesh}


def held_out(file: Path, count: int) -> SnapshotSet:
    """Random states of a scene."""
    place = file.with_suffix("") / "held-out"
    sets.farm(1, file, place, "--random", str(count), "--seed", str(SEED))
    return SnapshotSet(place)


def row(run: Run, plan: Plan, taper: float) -> dict:
    """A finger of one taper: pressed on its plate by forces of all directions, and before a plane."""
    straight = plans.rod(run, plan)
    table = scene(straight, taper)
    own = {
        "pressed": table | {"load": {"force": plan.force * taper**2}, "sampling": {"lines": plan.lines}},
        "plane": table | {"obstacle": PLANE},
    }
    files = {name: sets.written(run.folder, f"{name} {taper}", sets.as_toml(one)) for name, one in own.items()}
    finger = straight.assembled(tomllib.loads(files["plane"].read_text()))
    plane, pressed = (held_out(files[name], plan.held_out) for name in ("plane", "pressed"))
    before, under = check(finger, plane), check_pressed(finger, pressed)
    return {
        "taper": taper,
        "cells": table["mesh"]["cells"][0],
        "elements": len(finger.pieces[0]),
        "states": before["states"],
        "failed": before["failed"] + under["failed"],
        "touching": before["touch"]["touching"],
        "wrong": before["touch"]["wrong_beyond_margin"],
        "tip": before["tip"],
        "force": before["contact_force"],
        "place_um": {key: 1e6 * under["place_m"][key] for key in ("median", "p95", "max")},
        "pressed_force": under["contact_force"],
        "covered": under["covered"],
        "inside": under["inside"],
    }


def measure(run: Run) -> list[dict]:
    """A row a taper."""
    plan, tapers = PLAN, TAPERS
    return [run.once(f"taper {taper}", row, run, plan, taper) for taper in tapers]
