"""Fingers that random objects press on, against the full-order model of the elements' own mesh."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import NamedTuple

import numpy as np

from rom import AmongObjects, Rod
from rom.error_statistics import quantiles
from rom.rod.objects.shapes import RigidObject
from studies.parts import Run
from studies.rods import plans
from studies.rods.full_order import FullOrder, Table
from studies.rods.objects import CORES, FELT

COUNTS = "no answer", "marked", "weak", "failed"


class Pressed(NamedTuple):
    """A finger under tensions, and what presses on it.

    Attributes:
        tensions: shape (t,) [N].
        objects: with their tables for a scene; d moves all.
        d: where they are [m].
        stands: whether the full-order finger is pulled against objects that stand there; otherwise they come from afar.
    """

    tensions: np.ndarray
    objects: list[tuple[RigidObject, Table]]
    d: float
    stands: bool = False


Draw = Callable[[Rod, np.random.Generator], Pressed | None]


def compared(
    run: Run, plan: plans.Plan, draw: Draw, seed: list[int], count: int, most: float = np.inf, on_rubber: bool = False
) -> dict:
    """Draws whose objects all press: errors and estimates of every force, and counts of what is not compared.

    Args:
        run: of the study.
        plan: of the finger.
        draw: makes one; None is drawn again.
        seed: of the random numbers.
        count: of draws that are compared.
        most: forces above it are counted as marked [N].
        on_rubber: whether what presses on plates alone is counted as weak.
    """
    finger, random = plans.rod(run, plan), np.random.default_rng(seed)
    full = FullOrder(tomllib.loads(plans.scene(run, plan).read_text()))
    rows: list[tuple[float, float, float]] = []
    found = dict.fromkeys((*COUNTS, "states"), 0)
    while found["states"] < count:
        drawn = draw(finger, random)
        if drawn is None:
            continue
        model = AmongObjects(rod=finger, obstacles=[one for one, _ in drawn.objects])
        point = np.append(drawn.tensions, np.full(len(drawn.objects), drawn.d))
        answer = model.evaluate(point)
        forces, expected = np.asarray(answer.contact_force), np.asarray(answer.error["contact_force"])
        if not np.isfinite(expected).all():
            found["no answer"] += 1
        elif not answer.inside or forces.max() > most:
            found["marked"] += 1
        elif forces.min() < FELT or (on_rubber and not any(one.rubber for one in model.contact_forces(point))):
            found["weak"] += 1
        else:
            solve = full.pulled_against if drawn.stands else full.approached
            true = solve(together([table for _, table in drawn.objects]), drawn.tensions, drawn.d)
            if true is None:
                found["failed"] += 1
                continue
            found["states"] += 1
            rows += zip(np.abs(forces - true).tolist(), expected.tolist(), true.tolist(), strict=True)
    return {"rows": rows, **found}


def together(tables: list[Table]) -> Table:
    """Objects as the obstacle of a scene."""
    first, *others = tables
    placed = [{name: value for name, value in one.items() if name not in ("method", "distance")} for one in others]
    return first | ({"others": placed} if placed else {})


def summary(parts: list[dict]) -> dict:
    """Of what several processes have compared."""
    off, expected, true = np.array([row for part in parts for row in part["rows"]]).T
    return {
        **{name: sum(part[name] for part in parts) for name in (*COUNTS, "states")},
        "error": quantiles(off / true),
        "covered": float((off <= expected).mean()),
        "ratio": float(np.median(expected) / np.median(off)),
    }


def by_core(run: Run, plan: plans.Plan, calls: list[tuple]) -> list[dict]:
    """What `compared` returns of every call's arguments after the plan, each on one core."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    plans.rod(run, plan)
    with ProcessPoolExecutor(CORES, mp_context=get_context("spawn")) as pool:
        return [one.result() for one in [pool.submit(compared, run, plan, *call) for call in calls]]
