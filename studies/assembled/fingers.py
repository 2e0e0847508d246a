"""Fingers assembled from elements of another one, each against its own full-order model on a like mesh."""

from __future__ import annotations

from copy import deepcopy
from typing import NamedTuple

import numpy as np

from rom import Rod, TouchedSegment
from rom.error_statistics import quantiles
from studies.assembled.four import HIGHER_FOUR
from studies.parts import Run
from studies.rods import plans
from studies.rods.full_order import FullOrder, Table
from studies.rods.objects import scattered


class Made(NamedTuple):
    """A finger: cells along the rubber of each segment, and for every tendon of the elements the plates it ends at.

    Cells are as long as the trained ones, of which the draft finger has 19. The mesh error of order 1, 3.5 % of the
    tip's displacement, depends on their length.
    """

    cells: tuple[int, ...]
    plates: tuple[tuple[int, ...], ...]


BOTH, ONE, TWO = ((1,), (1,)), (1,), (2,)
OF_TWO_TENDONS = (
    *(Made((cells,), BOTH) for cells in (9, 15, 30, 46)),
    Made((19, 19), (ONE, TWO)),
    Made((19, 9), (ONE, TWO)),
    Made((15, 15, 15), (ONE, (3,))),
    Made((19, 9, 15), (TWO, (3,))),
)
OF_FOUR_TENDONS = Made((19, 19), (ONE, ONE, TWO, TWO)), Made((19, 19), ((1, 2),) * 4), Made((19, 11), ((1, 2),) * 4)
MOMENT = 0.2  # of the force on a plate about the clamp, at most [N m]: long fingers are pressed less
STATES, PLANES = 12, 12
SIZE, MODULUS = 1.7, 0.4  # of a similar finger, over the trained one's [-]


def assembled(trained: Rod, made: Made, force: float) -> tuple[Rod, Table]:
    """A finger of other segments and tendons, and its full-order scene.

    Args:
        trained: whose elements it is made of.
        made: its segments and tendons.
        force: on a plate, at most [N].
    """
    table: Table = {key: deepcopy(trained.elements.scene[key]) for key in ("geometry", "material", "tendons", "mesh")}
    whole, plate = table["geometry"]["segments"][0], table["geometry"]["plate"]
    cell = (whole - plate) / (table["mesh"]["cells"][0] - 1)  # one more is the plate's
    lengths = [cells * cell + plate for cells in made.cells]
    table["mesh"]["cells"][0] = max(made.cells) + 1
    table["geometry"]["segments"] = lengths
    # The base is pulled by all tendons, and the tip of a long finger must not meet the finger itself.
    share = min(1.0, whole / sum(lengths))
    table["tendons"] = [
        one | {"name": f"{one['name']}_{k}", "segment": k, "tension": [0.0, one["tension"][1] * share / len(plates)]}
        for one, plates in zip(table["tendons"], made.plates, strict=True)
        for k in plates
    ]
    table |= {"name": "assembled", "load": {"force": min(force, MOMENT / sum(lengths))}}
    return trained.assembled(table), table


def tips(finger: Rod, table: Table, count: int) -> dict:
    """Random tensions, every second state with forces on all plates: errors of the tip plate over its displacement."""
    full, random = FullOrder(table), np.random.default_rng(15)
    upper, segments = np.array([one.upper for one in finger.parameters]), len(finger.segments)
    rest = finger.place(0 * upper).centres[-1]
    errors: dict[str, list[float]] = {"free": [], "pressed": []}
    counts = dict.fromkeys(("beyond", "failed"), 0)
    for k in range(count):
        pulled, wrenches = upper * random.random(len(upper)), np.zeros((segments, 6))
        if k % 2:
            forces = random.standard_normal((segments, 3))
            forces *= table["load"]["force"] * random.random() / np.linalg.norm(forces, axis=1)[:, None] / segments
            points = finger.half_lengths * random.choice([-1.0, 1.0], (segments, 3))
            wrenches = np.hstack([forces, np.cross(points, forces)])
        placed, true = finger.place(pulled, wrenches), full.pressed(pulled, wrenches)
        if not placed.inside or true is None:
            counts["beyond" if not placed.inside else "failed"] += 1
            continue
        error, moved = placed.centres[-1] - true.plate_centres[-1], true.plate_centres[-1] - rest
        errors["pressed" if k % 2 else "free"].append(float(np.linalg.norm(error) / np.linalg.norm(moved)))
    return counts | {kind: quantiles(np.array(values)) for kind, values in errors.items()}


def row(trained: Rod, made: Made, force: float) -> dict:
    """One finger: its tip, and planes that touch a corner of its last plate."""
    finger, table = assembled(trained, made, force)
    return {
        "lengths_mm": [1e3 * one for one in table["geometry"]["segments"]],
        "tendons": len(table["tendons"]),
        "plates": [one["segment"] for one in table["tendons"]],
        "elements": [len(one.elements) for one in finger.segments],
        "force": table["load"]["force"],
        "tension": table["tendons"][0]["tension"][1],
        "tips": tips(finger, table, STATES),
        "planes": scattered(finger, table, "plane", PLANES),
    }


def similar(trained: Rod) -> dict:
    """A larger finger of softer rubber does the same as the trained one: largest relative difference of its plate."""
    table = deepcopy({key: trained.scene[key] for key in ("geometry", "material", "tendons")})
    force = MODULUS * SIZE**2
    for name, value in table["geometry"].items():
        if value is not None:
            table["geometry"][name] = (np.array(value) * SIZE).tolist()
    table["material"]["C1"] *= MODULUS
    table["material"]["D1"] /= MODULUS
    for tendon in table["tendons"]:
        tendon["offset"] = [SIZE * one for one in tendon["offset"]]
        tendon["tension"] = [force * one for one in tendon["tension"]]
    large, worst = trained.assembled(table), 0.0
    for draw in np.random.default_rng(16).random((100, 8)):
        pulled, pressed = 100 * draw[:2], np.append(draw[2:5] - 0.5, 0.01 * (draw[5:] - 0.5))
        one = trained.place(pulled, pressed[None])
        other = large.place(force * pulled, (force * pressed * np.repeat([1, SIZE], 3))[None])
        worst = max(worst, float(np.abs(other.centres / SIZE - one.centres).max() / trained.rest[0]))
        worst = max(worst, float(np.abs(other.rotations - one.rotations).max()))
    return {"size": SIZE, "modulus": MODULUS, "states": 100, "largest": worst}


def measure(run: Run) -> dict:
    """A row a finger, then similarity."""
    rows = [
        run.once(f"{made.cells} cells, {made.plates}", row, plans.rod(run, plan), made, plan.force)
        for plan, fingers in ((plans.HIGHER, OF_TWO_TENDONS), (HIGHER_FOUR, OF_FOUR_TENDONS))
        for made in fingers
    ]
    return {"fingers": rows, "similar": run.once("similar", similar, TouchedSegment.load().rod)}
