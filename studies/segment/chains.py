"""A finger of two segments and four tendons from two maps of one segment each, against its full-order model."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np

from rom import Chain, TouchedSegment
from rom.segment import build
from rom.segment.objects import facing_plane
from rom.segment.segment_map import quantiles
from rom.snapshots.snapshot_set import SnapshotSet
from studies import sets
from studies.runner import ROOT, Run
from studies.segment.full_order import FullOrder, obstacle

# Long tendons bend both segments towards the plane, short ones the first one back: name, offset [m], plate.
TENDONS = (
    ("long_y", (0.004, 0.0), 2),
    ("long_z", (0.0, 0.004), 2),
    ("short_y", (-0.004, 0.0), 1),
    ("short_z", (0.0, -0.004), 1),
)
MOST, FORCE = 25.0, 2.0  # tensions, forces on a plate [N]
LENGTH, REACH = 0.05, 0.055  # of a segment; from its plate to where the next one is pressed [m]
LINES = {"base": 80, "tip": 40}  # of 5 states each
TERMS = {"base": 2500, "tip": 1500}
FELT = 0.02  # contact force that relative errors are of, at least [N]
DEEPEST = 0.004  # [m]: how far the plane comes beyond the free finger
FREE, PRESSED = 10, 40  # full-order states


def scene(run: Run, name: str) -> Path:
    """The file of one segment's scene, or of both together."""
    segments = 2 if name == "both" else 1
    head = (ROOT / "scenes" / "two_segments.toml").read_text().split("[[tendons]]")[0]
    text = head.replace("[0.050, 0.050]", str([LENGTH] * segments))
    for tendon, offset, plate in TENDONS:
        if name == "tip" and plate == 1:
            continue
        text += f'[[tendons]]\nname = "{tendon}"\noffset = {list(offset)}\nsegment = {min(plate, segments)}\n'
        text += f"tension = [0.0, {MOST}]\n\n"
    reach = f"reach = {REACH}\n" if name == "base" else ""
    lines = f"lines = {LINES.get(name, 1) // (4 if run.quick else 1)}\n" if name != "both" else ""
    text += f"[load]\nforce = {FORCE}\n{reach}\n[mesh]\ncells = [20, 7]\norder = 1\n\n[sampling]\n{lines}"
    return sets.written(run.folder, f"{name} of two", text)


def trained(run: Run) -> tuple[Chain, dict[str, SnapshotSet]]:
    """The chain, from its file if it has one, and its sets."""
    file, training = run.folder / "chain.h5", {name: sets.training(scene(run, name)) for name in LINES}
    if not file.exists():
        Chain([build.train(training[name], TERMS[name]) for name in LINES]).save(file)
    return Chain.load(file), training


def against_full_order(run: Run) -> dict:
    """Free tips, then contact with the plane y = side/2 + d."""
    chain, training = trained(run)
    full, random = FullOrder(tomllib.loads(scene(run, "both").read_text())), np.random.default_rng(12)
    plane = facing_plane(2 * chain.half_lengths[1], (1e-4, 0.1))
    model = TouchedSegment(segment=chain, obstacle=plane)
    tips: list[float] = []
    errors: list[float] = []
    expected: list[float] = []
    counts = dict.fromkeys(("marked", "weak", "failed", "rubber"), 0)
    for _ in range(4 if run.quick else FREE):
        pulled = MOST * random.random(len(TENDONS))
        tips.append(float(np.linalg.norm(chain.place(pulled).centres[-1] - full.centres(pulled)[-1])))
    while len(errors) < (2 if run.quick else PRESSED):
        pulled = MOST * random.random(len(TENDONS))
        touch = float(model.outputs(np.array([*pulled, 0.1]))[0, 4])
        d = touch - DEEPEST * random.random()
        if d < 1e-3:
            continue
        answer = model.answers(np.array([*pulled, d]))
        if not answer.inside[0]:
            counts["marked"] += 1
            continue
        force = float(answer.out[0, 3])
        if force < FELT:
            counts["weak"] += 1
            continue
        true = full.force(obstacle(plane), pulled, d, answer.wrenches[0])
        if true is None or true[1]:
            counts["failed" if true is None else "rubber"] += 1
            continue
        errors.append(abs(force - true[0]) / true[0])
        expected.append(float(model.evaluate([*pulled, d]).error["contact_force"]) / true[0])
    return {
        "states": {name: one.states for name, one in training.items()},
        "core_seconds": sum(one.core_seconds for one in training.values()),
        "terms": [len(one.pose.powers) for one in chain.segments],
        "tip_um": {key: 1e6 * value for key, value in quantiles(np.array(tips)).items() if key != "count"},
        "free": len(tips),
        "error": quantiles(np.array(errors)),
        "covered": float(np.mean(np.array(errors) <= np.array(expected))),
        **counts,
    }


def todays(run: Run) -> dict:
    """The surrogate of the planar finger of two tendons before one plane, which docs/surrogate.md measures."""
    training = sets.training(sets.scene(run.sets, "two segments", run.quick))
    return {"states": training.states, "core_seconds": training.core_seconds}


def measure(run: Run) -> dict:
    """Both."""
    return {
        "chain": run.once("two segments, four tendons", against_full_order, run),
        "surrogate": run.once("today's two segments", todays, run),
    }
