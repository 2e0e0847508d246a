"""Contact about the map against the full-order model: random planes, round objects, boxes, and the paper's plane."""

from __future__ import annotations

import tomllib
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np

from control.model import Model
from rom import TouchedSegment
from rom.build import train
from rom.segment.objects import facing_plane
from rom.segment.segment_map import quantiles
from rom.separation.alternating_directions import EnrichmentOptions
from rom.snapshots.snapshot_set import SnapshotSet, read_task
from studies import sets
from studies.runner import Run
from studies.segment import maps
from studies.segment.full_order import FullOrder
from studies.segment.scattered_objects import DISTANCE, SHAPES, placed, tensions

CORES = 2
DEEPEST = 0.004  # [m]: how far objects come beyond the free plate
FELT = 0.05  # contact force that relative errors are of, at least [N]


def scattered(run: Run, plan: maps.Plan, shape: str, count: int) -> dict:
    """Random objects of one shape."""
    segment, random = maps.segment(run, plan), np.random.default_rng(9)
    full = FullOrder(tomllib.loads(maps.scene(run, plan).read_text()))
    errors: list[float] = []
    expected: list[float] = []
    counts = dict.fromkeys(("no answer", "marked", "weak", "failed", "rubber"), 0)
    while len(errors) < count:
        pulled = tensions(segment, random)
        found, table = placed(segment, pulled, random, shape)
        d = DISTANCE - DEEPEST * random.random()
        model = TouchedSegment(segment=segment, obstacle=found)
        answer = model.answers(np.array([*pulled, d]))
        force = float(answer.out[0, 3])
        if answer.evaluations[0] < 0:
            counts["no answer"] += 1
            continue
        if not answer.inside[0]:
            counts["marked"] += 1
            continue
        if force < FELT:
            counts["weak"] += 1
            continue
        true = full.force(table, pulled, d, answer.wrenches[0])
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


def by_shape(run: Run, plan: maps.Plan, count: dict[str, int]) -> list[dict]:
    """Random objects of every shape, a shape a process."""
    with ProcessPoolExecutor(CORES, mp_context=get_context("spawn")) as pool:
        return [one.result() for one in [pool.submit(scattered, run, plan, shape, count[shape]) for shape in SHAPES]]


def rubber_touches(states: SnapshotSet) -> np.ndarray:
    """Whether rubber touches the paper's plane in held-out states, shape (n,), by where its nodes are."""
    found, plate = [], states.body.plates[-1, 0]
    rubber = states.nodes[:, 0] < plate - 1e-6
    side = 2 * states.body.half_lengths[1]
    for name in states.plan.lines:
        task = read_task(states.path, name, ("converged", "displacement", "parameters"))
        for k in np.flatnonzero(task["converged"]):
            heights = (states.nodes + task["displacement"][k])[rubber, 1]
            found.append(heights.max() > side / 2 + task["parameters"][k, -1])
    return np.array(found)


def papers_plane(run: Run, plan: maps.Plan) -> dict:
    """The paper's plane: held-out states of the draft scene, the segment's map beside today's surrogate."""
    file = sets.scene(run.sets, "draft", run.quick)
    training = sets.training(file)
    held_out = sets.held_out(file, sets.QUICK_HELD_OUT if run.quick else sets.HELD_OUT)
    surrogate, segment = train(training, EnrichmentOptions()), maps.segment(run, plan)
    model = TouchedSegment(segment=segment, obstacle=facing_plane(2 * segment.half_lengths[1], (0.001, 0.031)))
    points, force = held_out.random("parameters"), held_out.random("contact_force")
    rubber, felt = rubber_touches(held_out), force > FELT
    answer = model.answers(points)
    borne = segment.place(np.column_stack([points[:, :-1], answer.wrenches])).inside
    within = borne & (answer.evaluations > 0)
    near = answer.rubber_gaps < segment.skin_error
    compared = felt & within & ~rubber & ~near

    def error(one: Model, of: np.ndarray) -> dict[str, float]:
        return quantiles(np.abs(one.outputs(points[of])[:, 3] - force[of]) / force[of])

    return {
        "force": plan.force,
        "states": int(felt.sum()),
        "beyond": int((felt & ~within).sum()),
        "rubber": int((felt & within & rubber).sum()),
        "rubber_noticed": int((felt & within & rubber & near).sum()),
        "marked_for_nothing": int((felt & within & ~rubber & near).sum()),
        "segment": error(model, compared),
        "surrogate": error(surrogate, compared),
        "surrogate_states": training.states,
        "surrogate_on_rubber": error(surrogate, felt & rubber),
    }


def measure(run: Run) -> dict:
    """All of it."""
    plans = [maps.QUICK] if run.quick else [maps.SMALL, maps.LARGE]
    count = dict.fromkeys(SHAPES, 2) if run.quick else {"plane": 200, "sphere": 100, "cylinder": 100, "box": 60}
    maps.segment(run, plans[0])
    return {
        "scattered": run.once("random objects", by_shape, run, plans[0], count),
        "paper": [run.once(f"the paper's plane, {plan.name}", papers_plane, run, plan) for plan in plans],
    }
