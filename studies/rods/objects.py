"""Contact of an assembled finger against the full-order model: random objects, and the paper's plane."""

from __future__ import annotations

import os
import tomllib
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np

from rom import Rod, TouchedSegment
from rom.error_statistics import quantiles
from rom.held_out import check
from studies import sets
from studies.parts import Run
from studies.rods import plans
from studies.rods.full_order import FullOrder, Table
from studies.rods.scattered_objects import DISTANCE, SHAPES, placed, tensions

CORES = 2
DEEPEST = 0.004  # [m]: how far objects come beyond the free plate
FELT = 0.05  # contact force that relative errors are of, at least [N]


def scattered(finger: Rod, table: Table, shape: str, count: int) -> dict:
    """Random objects of one shape, against the full-order model of a scene with a load."""
    full, random, most = FullOrder(table), np.random.default_rng(9), table["load"]["force"]
    errors: list[float] = []
    expected: list[float] = []
    counts = dict.fromkeys(("no answer", "marked", "weak", "failed", "rubber"), 0)
    while len(errors) < count:
        pulled = tensions(finger, random)
        found, touched = placed(finger, pulled, random, shape)
        d = DISTANCE - DEEPEST * random.random()
        model = TouchedSegment(rod=finger, obstacle=found)
        answer = model.answers(np.array([*pulled, d]))
        force = float(answer.out[0, 3])
        if answer.evaluations[0] < 0:
            counts["no answer"] += 1
            continue
        if not answer.inside[0] or force > most:
            counts["marked"] += 1
            continue
        if force < FELT:
            counts["weak"] += 1
            continue
        if any(one.rubber for one in model.contact_forces([*pulled, d])):
            counts["rubber"] += 1
            continue
        true = full.force(touched, pulled, d, answer.wrenches[0])
        if true is None:
            counts["failed"] += 1
            continue
        if true[1]:
            counts["rubber"] += 1
            continue
        errors.append(abs(force - true[0]) / true[0])
        expected.append(float(model.evaluate([*pulled, d]).error["contact_force"]) / true[0])
    covered = np.array(errors) <= np.array(expected)
    return {"shape": shape, **counts, "error": quantiles(np.array(errors)), "covered": float(covered.mean())}


def by_shape(run: Run, plan: plans.Plan, count: dict[str, int]) -> list[dict]:
    """Random objects of every shape, a shape a process, each on one core."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    finger, table = plans.rod(run, plan), tomllib.loads(plans.scene(run, plan).read_text())
    with ProcessPoolExecutor(CORES, mp_context=get_context("spawn")) as pool:
        return [
            one.result() for one in [pool.submit(scattered, finger, table, shape, count[shape]) for shape in SHAPES]
        ]


def papers_plane(run: Run, plan: plans.Plan) -> dict:
    """The paper's plane: held-out states of the draft scene."""
    held_out = sets.held_out(sets.draft(run.sets), sets.HELD_OUT)
    return {"force": plan.force} | check(plans.rod(run, plan), held_out)


def measure(run: Run) -> dict:
    """All of it."""
    listed = [plans.SMALL, plans.LARGE]
    count = {"plane": 100, "sphere": 60, "cylinder": 60, "box": 30}
    plans.rod(run, listed[0])
    return {
        "scattered": run.once("random objects", by_shape, run, listed[0], count),
        "paper": [run.once(f"the paper's plane, {plan.name}", papers_plane, run, plan) for plan in listed],
    }
