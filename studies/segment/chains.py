"""Fingers of two and of three segments from one map of each, against their full-order models."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rom import Rod, Cylinder, TouchedSegment
from rom.error_statistics import quantiles
from rom.rod.objects import Object, facing_plane
from rom.segment.training import build
from rom.snapshots.snapshot_set import SnapshotSet
from studies import sets
from studies.runner import ROOT, Run
from studies.segment.full_order import FullOrder, obstacle

Tendon = tuple[str, tuple[float, float], int]  # name, offset [m], the plate that it ends at


@dataclass(frozen=True)
class Finger:
    """A finger of several segments of the same length.

    Attributes:
        name: for files.
        tendons: all of them.
        most: tension [N].
        force: largest on a plate [N].
        lines: of 5 states each, segment by segment from the clamp.
        terms: of the maps, likewise.
    """

    name: str
    tendons: tuple[Tendon, ...]
    most: float
    force: float
    lines: tuple[int, ...]
    terms: tuple[int, ...]


# Long tendons bend all segments towards the plane, short ones the first one back. Every segment has channels along both
# sides: where the tip had one alone, its grid lines were others than the whole finger's, and its plate off by 16 um.
TWO = Finger(
    name="two",
    tendons=(
        ("long_y", (0.004, 0.0), 2),
        ("long_z", (0.0, 0.004), 2),
        ("short_y", (-0.004, 0.0), 1),
        ("short_z", (0.0, -0.004), 1),
    ),
    most=25.0,
    force=2.0,
    lines=(80, 40),
    terms=(2500, 1500),
)
THREE = Finger(
    name="three",
    tendons=(("long_y", (0.004, 0.0), 3), ("long_z", (0.0, 0.004), 3), ("short_y", (-0.004, 0.0), 1)),
    most=15.0,
    force=1.0,
    lines=(80, 60, 40),
    terms=(2500, 2000, 1500),
)
LENGTH, BEYOND = 0.05, 0.005  # of a segment; how much farther than a following segment's end it may be pressed [m]
FELT = 0.02  # contact force that relative errors are of, at least [N]
DEEPEST = {"plane": 0.004, "bar": 0.001}  # [m]: how far an object comes beyond the free finger
RADIUS, AWAY = 0.001, 0.03  # of a bar; where it touches the free finger [m]
FREE = 10  # full-order states


def scene(run: Run, finger: Finger, only: int | None = None) -> Path:
    """The file of one segment's scene, from the clamp, or of all together."""
    count = len(finger.lines)
    segments = count if only is None else 1
    head = (ROOT / "scenes" / "two_segments.toml").read_text().split("[[tendons]]")[0]
    text = head.replace("[0.050, 0.050]", str([LENGTH] * segments))
    for tendon, offset, plate in finger.tendons:
        if only is not None and plate <= only:
            continue
        text += f'[[tendons]]\nname = "{tendon}"\noffset = {list(offset)}\nsegment = {min(plate, segments)}\n'
        text += f"tension = [0.0, {finger.most}]\n\n"
    follow = count - 1 - only if only is not None else 0
    reach = f"reach = {follow * LENGTH + BEYOND}\n" if follow else ""
    lines = f"lines = {finger.lines[only] // (2 if run.quick else 1)}\n" if only is not None else ""
    text += f"[load]\nforce = {finger.force}\n{reach}\n[mesh]\ncells = [20, 7]\norder = 1\n\n[sampling]\n{lines}"
    return sets.written(run.folder, f"{finger.name} {'whole' if only is None else only}", text)


def trained(run: Run, finger: Finger) -> tuple[Rod, list[SnapshotSet]]:
    """The chain, from its file if it has one, and its sets."""
    training = [sets.training(scene(run, finger, k)) for k in range(len(finger.lines))]
    file = run.folder / f"chain-{finger.name}.h5"
    if not file.exists():
        few = 3 if run.quick else 1
        maps = [build.train(one, terms // few) for one, terms in zip(training, finger.terms, strict=True)]
        Rod(maps).save(file)
    return Rod.load(file), training


def plane(chain: Rod, pulled: np.ndarray, random: np.random.Generator) -> Object:
    """The plane y = side/2 + d."""
    return facing_plane(2 * chain.half_lengths[1], (1e-4, 0.1))


def bar(chain: Rod, pulled: np.ndarray, random: np.random.Generator) -> Object:
    """A thin bar across the finger that comes to a corner of a middle plate, from any side, and touches it at AWAY."""
    free, which = chain.place(pulled), int(random.integers(len(chain.segments) - 1))
    centre, rotation, angle = free.centres[which], free.rotations[which], random.uniform(0, 2 * np.pi)
    side = rotation @ np.array([0.0, np.cos(angle), np.sin(angle)])
    across = chain.half_lengths[1] * (np.abs(np.cos(angle)) + np.abs(np.sin(angle)))
    return Cylinder(
        centre=tuple(centre + (across + RADIUS - AWAY) * side),
        radius=RADIUS,
        axis=tuple(np.cross(side, rotation[:, 0])),
        direction=tuple(side),
        distances=(0.0, 0.1),
    )


def pressed(finger: Finger, chain: Rod, full: FullOrder, kind: str, count: int) -> dict:
    """Contact with a kind of object, beside the full-order model."""
    random = np.random.default_rng(12)
    errors: list[float] = []
    expected: list[float] = []
    beyond_tip = 0
    counts = dict.fromkeys(("marked", "weak", "failed", "rubber"), 0)
    while len(errors) < count:
        pulled = finger.most * random.random(len(finger.tendons))
        found = OBJECTS[kind](chain, pulled, random)
        model = TouchedSegment(segment=chain, obstacle=found)
        d = float(model.outputs(np.array([*pulled, 0.1]))[0, 4]) - DEEPEST[kind] * random.random()
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
        true = full.force(obstacle(found), pulled, d, answer.wrenches[0])
        if true is None or true[1]:
            counts["failed" if true is None else "rubber"] += 1
            continue
        errors.append(abs(force - true[0]) / true[0])
        expected.append(float(model.evaluate([*pulled, d]).error["contact_force"]) / true[0])
        beyond_tip += bool(answer.wrenches[0, :-6].any())
    return {
        "error": quantiles(np.array(errors)),
        "covered": float(np.mean(np.array(errors) <= np.array(expected))),
        "at_middle_plates": beyond_tip,
        **counts,
    }


OBJECTS: dict[str, Callable[[Rod, np.ndarray, np.random.Generator], Object]] = {"plane": plane, "bar": bar}


def against_full_order(run: Run, finger: Finger, contacts: dict[str, int]) -> dict:
    """Free tips, then contact, by the kind of object."""
    chain, training = trained(run, finger)
    full, random = FullOrder(tomllib.loads(scene(run, finger).read_text())), np.random.default_rng(12)
    tips: list[float] = []
    for _ in range(4 if run.quick else FREE):
        pulled = finger.most * random.random(len(finger.tendons))
        tips.append(float(np.linalg.norm(chain.place(pulled).centres[-1] - full.centres(pulled)[-1])))
    return {
        "segments": len(finger.lines),
        "tendons": len(finger.tendons),
        "states": [one.states for one in training],
        "core_seconds": sum(one.core_seconds for one in training),
        "terms": [len(one.pose.powers) for one in chain.segments],
        "tip_um": quantiles(1e6 * np.array(tips)),
        "contacts": {
            kind: pressed(finger, chain, full, kind, 2 if run.quick else count) for kind, count in contacts.items()
        },
    }


def todays(run: Run) -> dict:
    """The surrogate of the planar finger of two tendons before one plane, which docs/surrogate.md measures."""
    training = sets.training(sets.scene(run.sets, "two segments", run.quick))
    return {"states": training.states, "core_seconds": training.core_seconds}


def measure(run: Run) -> dict:
    """Fingers of two and three segments, and today's surrogate of two."""
    found = {"two": run.once("two segments", against_full_order, run, TWO, {"plane": 40, "bar": 20})}
    if not run.quick:
        found["three"] = run.once("three segments", against_full_order, run, THREE, {"plane": 15, "bar": 10})
    return found | {"surrogate": run.once("today's two segments", todays, run)}
