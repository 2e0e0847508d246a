"""Friction of tendons in their guides: histories of the motors against the full-order model, and a hysteresis."""

from __future__ import annotations

import tomllib
from itertools import pairwise
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from rom import GuidedFinger, Rod, TouchedSegment, guide_history
from rom.error_statistics import quantiles
from rom.rod.guides.guided_finger import GuideState
from rom.rod.objects.shapes import facing_plane
from studies.axes import large_letters
from studies.cores import on_cores
from studies.parts import Run
from studies.rods import plans

COUNT, POINTS, INCREMENTS = 40, 4, 2  # histories; points of each, and increments between two
PULLED, FRICTION = ((0.0, 80.0), (0.0, 40.0)), (0.1, 0.3)  # tensions [N], coefficients [-]
PRESSED = 6  # more histories before a plane
DISTANCE = (0.001, 0.031)  # of the plane [m]
NEAR = (0.008, 0.014)  # d of the plane [m]
TURNS, RUBBING = (0.0, 80.0, 20.0, 80.0, 0.0), 0.2  # of F1 in the hysteresis [N]; its coefficient [-]
LEAST = 1e-9  # work that counts [J]
ONE, BOTH = [[80.0, 0.0], [20.0, 0.0]], [[80.0, 10.0], [80.0, 60.0], [20.0, 60.0], [20.0, 10.0]]  # loops [N]
LOOP = 1000  # increments between two corners
STEP, FINE = 5.0, 64  # between points of the hysteresis [N]; increments that count as many


def draw(seed: int, is_pressed: bool) -> tuple[np.ndarray, float]:
    """Points of a history that pulls and releases, with one d if a plane is there; and its coefficient."""
    random = np.random.default_rng([43, seed, is_pressed])
    points = np.column_stack([random.uniform(*ends, POINTS) for ends in PULLED])
    if is_pressed:
        points = np.column_stack([points, np.full(POINTS, random.uniform(*NEAR))])
    return points, float(random.uniform(*FRICTION))


def at_plate(rod: Rod, full: Any, state: Any) -> np.ndarray:
    """Tensions of a full-order state where the middle of the rod's plate piece is, shape (t,) [N]."""
    from fingerfem.discretisation.guides import GuideLayers

    place = rod.segments[0].length - (rod.pieces[0][0].length + rod.segments[0].half_lengths[0]) / 2
    middles = GuideLayers(full.problem).middles
    return np.array([np.interp(place, *one) for one in zip(middles, state.layer_tensions, strict=True)])


def errors(rod: Rod, full: Any, ours: list[GuideState], theirs: list[Any]) -> dict[str, list[float]]:
    """Errors of every point, over the largest value of the history."""
    tips, lost = (np.array([getattr(one, name) for one in theirs]) for name in ("tip", "dissipated"))
    shortened = np.array([one.shortenings for one in theirs])
    reached = np.array([at_plate(rod, full, one) for one in theirs])
    found = {
        "tip": np.linalg.norm([one.tip for one in ours] - tips, axis=1) / np.linalg.norm(tips, axis=1).max(),
        "shortening": np.abs([one.shortenings for one in ours] - shortened).max(axis=1) / np.abs(shortened).max(),
        "tension": np.abs([one.element_tensions[0] for one in ours] - reached).max(axis=1) / reached.max(),
        "dissipated": np.abs([one.dissipated for one in ours] - lost) / max(lost.max(), LEAST),
    }
    forces = np.array([one.contact_force for one in theirs])
    if forces.any():
        found["force"] = np.abs([one.contact_forces[0] for one in ours] - forces) / forces.max()
    return {name: one.tolist() for name, one in found.items()}


def before_plane(rod: Rod) -> TouchedSegment:
    """The finger before the plane of the scene."""
    return TouchedSegment(rod=rod, obstacle=facing_plane(rod.scene["geometry"]["side"], DISTANCE))


def full_model(table: dict[str, Any], is_pressed: bool) -> Any:
    """The full-order finger, alone or before the plane."""
    from fingerfem import FingerModel
    from fingerfem.scene.scene import Scene

    given = {key: value for key, value in table.items() if key not in ("load", "sampling", "coarse")}
    return FingerModel(
        Scene.model_validate(
            given | ({"obstacle": {"distance": list(DISTANCE), "method": "penalty"}} if is_pressed else {})
        )
    )


def compared(rod: Rod, table: dict[str, Any], seed: int, is_pressed: bool) -> dict[str, Any]:
    """One history of both models; and the tip without friction, and in more increments."""
    from fingerfem import LoadNotReached
    from fingerfem.guide_history import guide_history as full_order

    points, friction = draw(seed, is_pressed)
    model, full = before_plane(rod) if is_pressed else rod, full_model(table, is_pressed)
    ours, free = (guide_history(model, points, one, increments=INCREMENTS) for one in (friction, 0.0))
    status = next((one.status for one in [*ours, *free] if one.status != "converged"), "converged")
    if status != "converged":
        return {"status": status}
    try:
        theirs = full_order(full, points, friction, increments=INCREMENTS)
        without = full_order(full, points, 0.0, increments=1)
    except LoadNotReached as failure:
        return {"status": "not_converged", "reason": str(failure)}
    fine = guide_history(model, points, friction, increments=FINE)
    moved = [float(np.linalg.norm(one.tip - other.tip)) for one, other in zip(ours, fine, strict=True)]
    return {
        "status": status,
        "friction": friction,
        "errors": errors(rod, full, ours, theirs),
        "without": errors(rod, full, free, without)["tip"],
        "increments": (np.array(moved) / max(float(np.linalg.norm(one.tip)) for one in ours)).tolist(),
    }


def errors_of(run: Run, is_pressed: bool) -> dict[str, Any]:
    """Errors of histories of one kind, over the largest value of each."""
    rod, table = plans.rod(run, plans.LARGE), tomllib.loads(plans.scene(run, plans.LARGE).read_text())
    rows = on_cores(compared, [(rod, table, seed, is_pressed) for seed in range(PRESSED if is_pressed else COUNT)])
    good = [row for row in rows if row["status"] == "converged"]
    names = ["tip", "shortening", "tension", "dissipated", *(["force"] if is_pressed else [])]
    return {
        "histories": len(rows),
        "compared": len(good),
        "reasons": [row for row in rows if row["status"] != "converged"],
        **{name: quantiles(np.concatenate([row["errors"].get(name, []) for row in good])) for name in names},
        **{name: quantiles(np.concatenate([row[name] for row in good])) for name in ("without", "increments")},
        "worst": [max(row["errors"]["tip"]) for row in good],
    }


def hysteresis(run: Run) -> dict[str, Any]:
    """Tension at the plate and displacement of the tip, as the motor pulls, releases and pulls again."""
    from fingerfem.guide_history import guide_history as full_order

    rod, table = plans.rod(run, plans.LARGE), tomllib.loads(plans.scene(run, plans.LARGE).read_text())
    parts = [np.linspace(one, other, int(abs(other - one) / STEP) + 1)[1:] for one, other in pairwise(TURNS)]
    pulled = np.concatenate(parts)
    points = np.column_stack([pulled, np.zeros_like(pulled)])
    ours = guide_history(rod, points, RUBBING, increments=1)
    full = full_model(table, False)
    theirs = full_order(full, points, RUBBING, increments=1)
    return {
        "pulled": pulled.tolist(),
        "rod": [[one.element_tensions[0, 0], 1e3 * one.tip[1]] for one in ours],
        "full": [[at_plate(rod, full, one)[0], 1e3 * one.tip[1]] for one in theirs],
        "capstan": max(
            np.abs(one.layer_tensions[0] / one_pull / np.exp(-RUBBING * one.turned[0]) - 1).max()
            for one, one_pull in zip(theirs[: len(parts[0])], parts[0], strict=True)
        ),
    }


def loop_work(rod: Rod, corners: list[list[float]], friction: float) -> dict[str, float]:
    """Work lost in a closed loop of the motors, and what friction took [J]."""
    finger, points = GuidedFinger(model=rod, friction=friction), np.array(corners)
    shares = np.arange(1, 1 + LOOP) / LOOP
    for _ in range(2):  # the second loop is closed
        begun = finger.advance(points[-1])
        for first, second in zip(np.roll(points, 1, axis=0), points, strict=True):
            for share in shares:
                state = finger.advance(first + share * (second - first))
    return {"lost": state.work - begun.work, "took": state.dissipated - begun.dissipated}


def draw_picture(found: dict[str, Any], file: Path) -> None:
    """Both models, over the motor's tension."""
    large_letters()
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.5), layout="constrained")
    for k, (axis, label) in enumerate(zip(axes, ("tension at the plate [N]", "tip along y [mm]"), strict=True)):
        for name, style, words in (("full", "k-", "full-order model"), ("rod", "C1o", "rod elements")):
            values = [0.0, *(one[k] for one in found[name])]
            axis.plot([0.0, *found["pulled"]], values, style, markersize=4, label=words)
        axis.set(xlabel="tension at the motor [N]", ylabel=label)
    axes[0].plot([0, max(found["pulled"])], [0, max(found["pulled"])], ":", color="grey", label="without friction")
    axes[0].legend()
    figure.savefig(file, dpi=90)
    plt.close(figure)


def measure(run: Run) -> dict[str, Any]:
    """Free histories, pressed ones, the hysteresis and its work."""
    loop = run.once("hysteresis", hysteresis, run)
    draw_picture(loop, run.folder / "tendon_friction.png")
    return {
        "capstan": loop["capstan"],
        "work": {
            name: loop_work(plans.rod(run, plans.LARGE), *given)
            for name, given in {"one": (ONE, RUBBING), "both": (BOTH, RUBBING), "free": (BOTH, 0.0)}.items()
        },
        "free": run.once("free", errors_of, run, False),
        "pressed": run.once("pressed", errors_of, run, True),
    }
