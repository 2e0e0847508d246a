"""Moving fingers of rod elements against the full-order model, on the mesh that they were trained on."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from rom import Cylinder, MovingFinger, Plane, Rod, Sphere, TouchedSegment
from rom.dataset.sections.section import top
from studies.motion.fingers import DENSITY, DISTANCES, Table, table, touching, trained
from studies.parts import Run

PRONY, SLOW = [[0.2, 0.01], [0.1, 0.3]], [[0.2, 0.5], [0.2, 300.0]]  # branches: modulus [-], time [s]
STEP, JUMP = 3e-3, 1e-4  # a step, and one in which loads jump [s]
SHORT = 1.25e-4  # step of an impact: the full-order peak is within 1 % of that at half of it [s]
MOTIONS: dict[str, Table] = {
    "step": {"loads": {"up": [[0.0, 0.0], [0.0, 2.0]]}},
    "two steps": {"loads": {"up": [[0.0, 0.0], [0.0, 1.2]], "right": [[0.06, 0.2], [0.06, 1.2]]}},
    "ramps": {"loads": {"up": [[0.0, 0.0], [0.06, 5.0]], "right": [[0.0, 0.0], [0.03, 2.0]]}},
    "release": {"loads": {"up": [[0.0, 3.0], [0.03, 3.0], [0.03, 1.0]]}},
    "moving base": {
        "loads": {"up": 1.0},
        "base": {
            "ay": {"amplitude": 3.0, "frequency": 5.0},
            "wz": [[0.0, 0.0], [0.06, 8.0], [0.15, -6.0]],
            "wx": {"amplitude": 6.0, "frequency": 4.0},
        },
    },
    "sine": {"loads": {"up": {"mean": 2.0, "amplitude": 1.5, "frequency": 6.0, "phase": -1.5707963}}},
    "pulse": {"loads": {"up": 1.0, "right": [[0.0, 0.0], [0.015, 4.0], [0.03, 0.0]]}},
}
OF = {
    "square": tuple(MOTIONS),
    "two segments": tuple(MOTIONS),
    "ring": ("step", "ramps", "release", "pulse"),
    "circle": ("step", "ramps"),
}
TIME = {"end": 0.15, "step": STEP}
IMPACT: Table = {"time": {"end": 0.06, "step": SHORT}, "loads": {"up": [[0.0, 0.0], [0.01, 1.5]]}}
HELD = {"time": {"end": 3600.0, "step": 60.0}, "loads": {"up": [[0.0, 0.0], [0.5, 4.0]], "d": 0.006}}
BEFORE = {"plane": 0.006, "ball": 0.002}  # d of what the plate falls on [m]
BALL: Table = {"centre": [0.079, 0.025, 0.0], "radius": 0.015}  # before the plate of the square finger [m]
FILTER = 1e-3  # mean of the impact's force over this time [s]
HALVINGS, FINE = (5e-4, 2.5e-4, 1.25e-4), 1.5625e-5  # steps of the order of convergence, and of its reference [s]
TENDONS = 4  # of the square finger
PULLED = [4.0, 1.0, 0.0, 0.0]  # tensions of timed steps [N]
JUMPED = [4.2, 1.0, 0.0, 0.0]  # those by which a finger vibrates that objects press on the rubber [N]
ALONG, DEEP, CURVED = 0.6, 5e-4, 0.015  # where these press, of the length [-]; how deep, and their radius [m]
APPROACH = 10  # steps at rest to this depth, from as far away
BLOCKS, BLOCK = 20, 50  # of timed steps, by turns: a block of each kind


def full_order(scene: Table, motion: Table) -> tuple[Any, dict[str, np.ndarray]]:
    """A motion, and columns with a row a step."""
    from fingerfem.dynamics.motion import motion_of
    from fingerfem.dynamics.simulation import Simulation
    from fingerfem.scene.scene import Scene

    rows: list[dict[str, float]] = []
    own = Scene.model_validate(scene)
    given = motion_of(motion, own)
    Simulation(own, given).run(lambda row, _: rows.append(row))
    return given, {name: np.array([row[name] for row in rows]) for name in rows[0]}


def followed(model: TouchedSegment, given: Any, times: np.ndarray, at_rest: bool = False) -> Iterator[Any]:
    """States of the rod at times but the first; where loads jump, a short step comes first."""

    def point(time: float, after: bool = False) -> np.ndarray:
        tensions, d = given.loads(time, after)
        return np.append(tensions, np.inf if d is None else d)

    finger = MovingFinger(model, point(0.0), DENSITY)
    for before, now in pairwise(times):
        if given.jumps(before):
            finger.step(point(before, True), JUMP, given.base(before, True) if given.base_moves else None)
        base = given.base(now, False) if given.base_moves else None
        yield finger.step(point(now), now - finger.time, base, at_rest=at_rest)


def tips(run: Run, finger: str, name: str) -> dict[str, Any]:
    """A motion: root mean square of the tip's error, over its largest displacement from where it began."""
    rod = trained(run, finger)
    given, full = full_order(table(rod, PRONY), {"time": TIME} | MOTIONS[name])
    theirs = np.array([full[f"tip_{axis}"] for axis in "xyz"]).T
    states = list(followed(touching(rod, PRONY), given, full["time"]))
    error = np.linalg.norm([one.tip for one in states] - theirs[1:], axis=1)
    way = np.linalg.norm(theirs - theirs[0], axis=1).max()
    return {
        "marked": sum(one.status != "converged" for one in states),
        "way": float(way),
        "rms": float(np.sqrt(np.mean(error**2)) / way),
        "largest": float(error.max() / way),
    }


def impact(rod: Rod, on: str) -> dict[str, Any]:
    """Relative errors of the peak force of an impact on an object, filtered, and of its impulse."""
    scene, model = table(rod, PRONY, before_plane=True), touching(rod, PRONY)
    if on == "ball":
        scene["obstacle"] |= {"shape": "sphere", "direction": [0.0, 1.0, 0.0]} | BALL
        model = replace(model, obstacle=Sphere(direction=(0.0, 1.0, 0.0), distances=DISTANCES, **BALL))
    given, full = full_order(scene, IMPACT | {"loads": IMPACT["loads"] | {"d": BEFORE[on]}})
    ours = [0.0, *(float(one.contact_forces[0]) for one in followed(model, given, full["time"]))]
    forces, steps = (full["contact_force"], np.array(ours)), round(FILTER / SHORT)
    peaks = [float(np.convolve(one, np.ones(steps) / steps, "same").max()) for one in forces]
    impulses = [float(np.diff(full["time"]) @ one[1:]) for one in forces]  # a force is the mean over the step before
    return {
        "peak": peaks[1] / peaks[0] - 1,
        "impulse": impulses[1] / impulses[0] - 1,
        "force": peaks[0],
        "steps": len(full["time"]) - 1,
    }


def held(rod: Rod) -> dict[str, Any]:
    """An hour against the plane, in steps of a minute: relative errors of force and tip at its end."""
    given, full = full_order(table(rod, SLOW, before_plane=True), HELD)
    *_, last = followed(touching(rod, SLOW), given, full["time"], at_rest=True)
    tip = np.array([full[f"tip_{axis}"][-1] for axis in "xyz"])
    return {
        "force": float(last.contact_forces[0] / full["contact_force"][-1] - 1),
        "tip": float(np.linalg.norm(last.tip - tip) / np.linalg.norm(tip)),
        "steps": len(full["time"]) - 1,
    }


def order(rod: Rod) -> list[float]:
    """Exponents by which the rod's error falls as steps are halved."""
    model = touching(rod, PRONY)

    def tip(length: float) -> np.ndarray:
        finger, count = MovingFinger(model, np.append(np.zeros(TENDONS), np.inf), DENSITY), round(0.02 / length)
        for k in range(1, count + 1):
            state = finger.step([2 * np.sin(np.pi * k / count / 2) ** 2, 0.0, 0.0, 0.0, np.inf], length)
        return state.tip

    exact = tip(FINE)
    errors = [float(np.linalg.norm(tip(length) - exact)) for length in HALVINGS]
    return [float(np.log2(one / other)) for one, other in pairwise(errors)]


def pressed_rubber(rod: Rod, shape: str) -> MovingFinger:
    """The finger at PULLED, with an object that presses on its rubber at d = 0: a plane on the convex side."""
    section = rod.sections(PULLED, at=[ALONG * rod.rest[0]])
    out = section.rotations[0] @ [0.0, -1.0 if shape == "plane" else 1.0, 0.0]
    surface = section.centres[0] + (top(rod.scene) - DEEP) * out
    where: dict[str, Any] = {"direction": tuple(out), "distances": (-0.1, 0.1)}
    obstacle: Plane | Sphere | Cylinder
    if shape == "plane":
        obstacle = Plane(centre=tuple(surface), normal=tuple(-out), **where)
    elif shape == "ball":
        obstacle = Sphere(centre=tuple(surface + CURVED * out), radius=CURVED, **where)
    else:
        obstacle = Cylinder(centre=tuple(surface + CURVED * out), radius=CURVED, **where)
    model = TouchedSegment(rod=rod, obstacle=obstacle)
    finger = MovingFinger(model, [*PULLED, np.inf], DENSITY)
    for d in 2 * DEEP * np.linspace(1.0, 0.0, APPROACH):
        finger.step([*PULLED, d], 0.05, at_rest=True)
    if not any(one.rubber for one in model.contact_forces([*PULLED, 0.0])):
        raise ValueError(f"{shape} must press on the rubber, got contacts of plates alone")
    return finger


def step_times(rod: Rod) -> dict[str, float]:
    """Medians of a step's time from Python, by its kind, over that of an answer at rest [-]; all are timed by turns."""
    model, calls = touching(rod), dict[str, Callable[[], Any]]()
    calls["answer"] = lambda: model.evaluate([*PULLED, 0.006])
    for name, prony, d in (("free", None, np.inf), ("contact", None, 0.006), ("branches", PRONY, 0.006)):
        finger = MovingFinger(touching(rod, prony), [0.0, 0.0, 0.0, 0.0, d], DENSITY)
        calls[name] = partial(finger.step, [*PULLED, d], 1e-3)
    for shape in ("plane", "ball", "cylinder"):
        calls[f"rubber, {shape}"] = partial(pressed_rubber(rod, shape).step, [*JUMPED, 0.0], 1e-3)
    taken = {name: list[float]() for name in calls}
    for _ in range(BLOCKS):
        for name, call in calls.items():
            for _ in range(BLOCK):
                begun = time.perf_counter()
                call()
                taken[name].append(time.perf_counter() - begun)
    found = {name: float(np.median(one)) for name, one in taken.items()}
    return {name: one / found["answer"] for name, one in found.items()} | {"answer": 1e6 * found["answer"]}


def measure(run: Run) -> dict[str, Any]:
    """All of it, part by part."""
    pairs = [(finger, name) for finger, names in OF.items() for name in names]
    rod = trained(run, "square")
    return {
        "tips": {f"{finger}, {name}": run.once(f"{finger}, {name}", tips, run, finger, name) for finger, name in pairs},
        "impacts": {on: run.once(f"impact on a {on}", impact, rod, on) for on in BEFORE},
        "held": run.once("held", held, rod),
        "order": run.once("order", order, rod),
        "times": run.once("times", step_times, rod),
    }
