"""Other fingers of the bundled elements, against their own full-order models: lengths, two segments, sizes."""

from __future__ import annotations

from copy import deepcopy

import numpy as np

from rom import Rod, TouchedSegment
from rom.error_statistics import quantiles
from studies.parts import Run
from studies.rods.full_order import FullOrder, Table

LENGTHS = 0.025, 0.04, 0.08, 0.12  # of one segment [m]
TWO = (0.06, 0.035), (1, 2)  # lengths of two segments [m]; the plates that the tendons end at
MOST = 5.0, 0.2  # force on a plate [N], and its moment about the clamp [N m]; long fingers are pressed less
STATES = 6
SIZE, MODULUS = 1.7, 0.4  # of a similar finger, over the trained one's [-]


def finger_of(trained: Rod, lengths: tuple[float, ...], plates: tuple[int, ...] | None = None) -> tuple[Rod, Table]:
    """A finger of other segments, and its full-order scene with cells about as long as the trained ones."""
    table: Table = {key: deepcopy(trained.elements.scene[key]) for key in ("geometry", "material", "tendons", "mesh")}
    cell = table["geometry"]["segments"][0] / table["mesh"]["cells"][0]
    table["geometry"]["segments"] = list(lengths)
    table["mesh"]["cells"][0] = round(sum(lengths) / len(lengths) / cell)
    for tendon, plate in zip(table["tendons"], plates or [1] * len(table["tendons"]), strict=True):
        tendon["segment"] = plate
    table |= {"name": "assembled", "load": {"force": MOST[0]}}
    return trained.assembled(table), table


def compared(trained: Rod, lengths: tuple[float, ...], plates: tuple[int, ...] | None, count: int) -> dict:
    """Random tensions, every second state with a wrench on all plates: how far the tip plates are apart."""
    finger, table = finger_of(trained, lengths, plates)
    full, random = FullOrder(table), np.random.default_rng(15)
    most, half = min(MOST[0], MOST[1] / sum(lengths)), finger.half_lengths
    upper = np.array([one.upper for one in finger.parameters])
    # The base of a finger of two segments is pulled by both tendons, its tip by one: neither meets the finger itself.
    upper *= min(1.0, trained.scene["geometry"]["segments"][0] / sum(lengths))
    tips: dict[str, list[float]] = {"free": [], "pressed": []}
    counts = dict.fromkeys(("beyond", "failed"), 0)
    for k in range(count):
        pulled, wrenches = upper * random.random(len(upper)), np.zeros((len(lengths), 6))
        if k % 2:
            forces = random.standard_normal((len(lengths), 3))
            forces *= most * random.random() / np.linalg.norm(forces, axis=1)[:, None] / len(lengths)
            points = half * random.choice([-1.0, 1.0], (len(lengths), 3))
            wrenches = np.hstack([forces, np.cross(points, forces)])
        placed, true = finger.place(pulled, wrenches), full.pressed(pulled, wrenches)
        if not placed.inside or true is None:
            counts["beyond" if not placed.inside else "failed"] += 1
            continue
        off = placed.centres[-1] - true.plate_centres[-1]
        tips["pressed" if k % 2 else "free"].append(1e6 * float(np.linalg.norm(off)))
    return {
        "lengths_mm": [1e3 * one for one in lengths],
        "plates": list(plates or ()),
        "elements": [len(one.elements) for one in finger.segments],
        "most_force": most,
        "most_tensions": upper.tolist(),
        **{f"{kind}_um": quantiles(np.array(off)) for kind, off in tips.items()},
        **counts,
        "expected_um": 1e6 * finger.errors.position,
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
    """Lengths, then two segments, then similarity."""
    trained, count = TouchedSegment.load().rod, STATES
    listed = LENGTHS
    rows = [run.once(f"{1e3 * one:g} mm", compared, trained, (one,), None, count) for one in listed]
    two = run.once("two segments", compared, trained, *TWO, count)
    return {"lengths": rows, "two": two, "similar": run.once("similar", similar, trained)}
