"""Two objects at once, against the full-order model of the elements' own mesh."""

from __future__ import annotations

import os
import tomllib
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context

import numpy as np

from rom.error_statistics import quantiles
from rom.rod.objects.shapes import Object
from rom.rod.touched_rod import AmongObjects
from rom.rod.touched_segment import TouchedSegment
from studies.rods import plans
from studies.rods.full_order import FullOrder, Table
from studies.rods.objects import CORES, FELT
from studies.rods.rubber import DEPTHS, MOST, anywhere, clear_of_clamp
from studies.rods.scattered_objects import DISTANCE, SHAPES, tensions
from studies.runner import Run


def advanced(found: Object, table: Table, depth: float) -> tuple[Object, Table]:
    """An object that is nearer by a depth [m] at every d, and its table."""
    way = depth * np.array(found.numbers()["direction"])
    moved = replace(found, centre=tuple((np.array(found.centre) - way).tolist()))
    return moved, table | {"centre": list(moved.centre)}


def compared(run: Run, plan: plans.Plan, seed: int, count: int) -> dict:
    """Pairs of random objects that both press, each at a random place and of a random shape."""
    finger, random = plans.rod(run, plan), np.random.default_rng([31, seed])
    full = FullOrder(tomllib.loads(plans.scene(run, plan).read_text()))
    rows: list[tuple[float, float, float]] = []
    counts = dict.fromkeys(("no answer", "marked", "weak", "failed"), 0)
    while len(rows) < 2 * count:
        pulled, pairs = tensions(finger, random), []
        for shape in random.choice(SHAPES, 2):
            found, table = anywhere(finger, pulled, random, str(shape))
            pairs.append(advanced(found, table, float(np.exp(random.uniform(*np.log(DEPTHS))))))
        objects, tables = zip(*pairs, strict=True)
        alone = [TouchedSegment(rod=finger, obstacle=one) for one in objects]
        if not all(clear_of_clamp(one, DISTANCE) for one in alone):
            continue
        model = AmongObjects(rod=finger, obstacles=objects)
        answer = model.evaluate([*pulled, DISTANCE, DISTANCE])
        forces, expected = np.asarray(answer.contact_force), np.asarray(answer.error["contact_force"])
        if not np.isfinite(expected).all():
            counts["no answer"] += 1
        elif forces.min() < FELT:
            counts["weak"] += 1
        elif not answer.inside or forces.max() > MOST:
            counts["marked"] += 1
        else:
            true = full.approached(tables[0] | {"others": [_placed(one) for one in tables[1:]]}, pulled, DISTANCE)
            if true is None:
                counts["failed"] += 1
            else:
                rows += zip(np.abs(forces - true).tolist(), expected.tolist(), true.tolist(), strict=True)
    return {"rows": rows, **counts}


def _placed(table: Table) -> Table:
    """What places an object, without what is asked once of all."""
    return {name: value for name, value in table.items() if name not in ("method", "distance")}


def measure(run: Run) -> dict:
    """A process a core."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    plan, count = (plans.QUICK, 1) if run.quick else (plans.LARGE, 15)
    plans.rod(run, plan)
    with ProcessPoolExecutor(CORES, mp_context=get_context("spawn")) as pool:
        parts = [one.result() for one in [pool.submit(compared, run, plan, seed, count) for seed in range(CORES)]]
    off, expected, true = np.array([row for part in parts for row in part["rows"]]).T
    return {
        **{name: sum(part[name] for part in parts) for name in parts[0] if name != "rows"},
        "states": len(off) // 2,
        "error": quantiles(off / true),
        "covered": float((off <= expected).mean()),
        "ratio": float(np.median(expected) / np.median(off)),
    }
