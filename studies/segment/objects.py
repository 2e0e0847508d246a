"""Contact about the map against the full-order model: random objects, the paper's plane, and rubber that touches it."""

from __future__ import annotations

import os
import tomllib
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np

from control.model import Model
from rom import BackedSegment, Surrogate, TouchedSegment
from rom.build import train
from rom.error_statistics import quantiles
from rom.rod.objects import facing_plane
from rom.separation.alternating_directions import EnrichmentOptions
from rom.snapshots.snapshot_set import SnapshotSet, read_task
from studies import sets
from studies.runner import Run
from studies.segment import maps
from studies.segment.full_order import FullOrder, rubber_touches
from studies.segment.scattered_objects import DISTANCE, SHAPES, placed, tensions

CORES = 2
DEEPEST = 0.004  # [m]: how far objects come beyond the free plate
BOX = 10_000  # random states of the paper's box
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
    """Random objects of every shape, a shape a process, each on one core."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    with ProcessPoolExecutor(CORES, mp_context=get_context("spawn")) as pool:
        return [one.result() for one in [pool.submit(scattered, run, plan, shape, count[shape]) for shape in SHAPES]]


def todays(run: Run) -> Surrogate:
    """The surrogate of the paper's plane, from its file if it has one."""
    file = run.folder / "plane.h5"
    if not file.exists():
        training = sets.training(sets.scene(run.sets, "draft", run.quick))
        train(training, EnrichmentOptions()).save(file)
    return Surrogate.load(file)


def on_rubber(states: SnapshotSet) -> np.ndarray:
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
    held_out = sets.held_out(
        sets.scene(run.sets, "draft", run.quick), sets.QUICK_HELD_OUT if run.quick else sets.HELD_OUT
    )
    surrogate, segment = todays(run), maps.segment(run, plan)
    model = TouchedSegment(segment=segment, obstacle=facing_plane(2 * segment.half_lengths[1], (0.001, 0.031)))
    points, force = held_out.random("parameters"), held_out.random("contact_force")
    rubber, felt = on_rubber(held_out), force > FELT
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
        "surrogate_states": int(surrogate.provenance["states"]),
    }


def rubber_on_the_plane(run: Run, plan: maps.Plan, count: int) -> dict:
    """Random states of the paper's box in which the map notices rubber: answered by the surrogate behind it."""
    from fingerfem import FingerModel, load_scene
    from fingerfem.equilibrium.failures import LoadNotReached

    segment, surrogate = maps.segment(run, plan), todays(run)
    plane = facing_plane(2 * segment.half_lengths[1], (0.001, 0.031))
    model = BackedSegment(touched=TouchedSegment(segment=segment, obstacle=plane), surrogate=surrogate)
    full = FingerModel(load_scene(sets.scene(run.sets, "draft", run.quick)))
    lower, upper = model.limits
    points = lower + np.random.default_rng(13).random((BOX, len(lower))) * (upper - lower)
    found = model.touched.answers(points)
    contact = found.out[:, 3] > 0
    noticed = contact & (found.evaluations > 0) & (found.rubber_gaps < segment.skin_error)
    felt = points[noticed & (model.outputs(points)[:, 3] > FELT)]
    errors, expected, failed, touched = [], [], 0, 0
    for point in felt[:count]:
        try:
            state = full.solve(point[:-1], point[-1], sensitivities=False)
        except LoadNotReached:
            failed += 1
            continue
        assert state.contact_force is not None
        true, answer = state.contact_force, model.evaluate(point)
        errors.append(abs(float(answer.contact_force) - true) / true)
        expected.append(float(answer.error["contact_force"]) / true)
        touched += rubber_touches(full)
    return {
        "force": plan.force,
        "contacts": int(contact.sum()),
        "answered": int(np.sum(contact & found.inside)),
        "noticed": int(noticed.sum()),
        "beyond": int(np.sum(contact & ~found.inside & ~noticed)),
        "behind": int(np.sum(contact & ~found.inside & model.evaluate(points).inside)),
        "compared": len(errors),
        "failed": failed,
        "touched": touched,
        "error": quantiles(np.array(errors)),
        "covered": float(np.mean(np.array(errors) <= np.array(expected))),
    }


def measure(run: Run) -> dict:
    """All of it."""
    plans = [maps.QUICK] if run.quick else [maps.SMALL, maps.LARGE]
    count = dict.fromkeys(SHAPES, 2) if run.quick else {"plane": 200, "sphere": 100, "cylinder": 100, "box": 60}
    maps.segment(run, plans[0])
    return {
        "scattered": run.once("random objects", by_shape, run, plans[0], count),
        "rubber": run.once("rubber on the plane", rubber_on_the_plane, run, plans[-1], 5 if run.quick else 40),
        "paper": [run.once(f"the paper's plane, {plan.name}", papers_plane, run, plan) for plan in plans],
    }
