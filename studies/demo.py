"""The main job, end to end: train a finger, grasp with three of it, verify with the full-order model, report.

python3 studies/demo.py [OUT] [--quick]    writes OUT (out/demo by default); what is there already is not solved again

The finger is cut into rod elements, which few full-order states train: each begins at the same state on a coarse mesh.
The finger is assembled from them, and contact is solved for online. --quick takes coarse meshes alone: it tries the
demo, and its numbers mean nothing.
"""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict
from itertools import count
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from rom.console import terminal
from rom.console.interruption import interruptible

if __name__ == "__main__":  # before what takes seconds to import
    interruptible("demo: stopped by Ctrl-C: solved states are kept; run the same command again")

from control import Finger, Gripper, campaign
from control.export.page import write as write_page
from control.grasping.gripper import Grasp
from control.model import Model
from fingerfem import FingerModel, load_scene
from fingerfem.full_order_plant import FullOrderPlant
from fingerfem.output.pictures import Deformed, draw
from rom.console.terminal import Progress, steps
from rom.dataset.snapshot_set import SnapshotSet
from rom.elements.fitting.training import train
from rom.elements.samples.section_states import read_section_states
from rom.plane_check import before_plane, check
from rom.rod.rod import Rod
from rom.rod.touched_segment import TouchedSegment
from rom.summaries import origin
from studies import report, sets

SCENES = Path(__file__).resolve().parents[1] / "scenes" / "demo"
CALLER = "FINGERFEM_CALLER"  # the demo, not the farm, prints what an interruption keeps
SHOW_CURSOR = "\x1b[?25h"  # which a bar hides, and a killed rank does not bring back
HELD_OUT, QUICK_HELD_OUT = 8, 4  # random tensions, each with four distances
# The fingers that are driven are on a mesh of their own, neither the fine nor the coarse one.
PLANTS = {"mesh": {"cells": [10, 5], "order": 2}}
# Meshes that are soon solved.
QUICK: dict[str, dict] = {
    "fine": {"mesh": {"cells": [20, 5], "order": 1}, "coarse": {"cells": [10, 5], "order": 1}},
    "plane": {"mesh": {"cells": [20, 5], "order": 1}},
    "plants": {"mesh": {"cells": [20, 5], "order": 1}},
    "plane_coarse": {"mesh": {"cells": [10, 5], "order": 1}},
}
CASES = [([50.0, 0.0], None), ([100.0, 0.0], None), ([50.0, 0.0], 0.005), ([60.0, 60.0], 0.008)]
TARGET = 1.0  # [N]
OBJECT_CENTRE, OBJECT_RADIUS = (0.002, -0.0015), 0.012  # [m]; the controller has neither
HOLDS = 10_000  # of the sweep
GOAL, FAR = [35.0, 25.0], [0.0, 0.2, 0.0]  # tensions of a state to reach [N]; a point out of reach [m]
HOLD_DISTANCES = [0.003, 0.006, 0.010, 0.014, 0.018]  # [m]


def farm(scene: str | Path, folder: Path, *options: str) -> tuple[SnapshotSet, dict]:
    """Solve a snapshot set on all cores."""
    cores = getattr(os, "process_cpu_count", os.cpu_count)()
    ranks = int(os.environ.get("FINGERFEM_RANKS") or cores or 1)
    words = ["mpirun", "-n", str(ranks), sys.executable, "-m", "fingerfem", "snapshots", str(scene), str(folder)]
    words += options
    if sys.stderr.isatty():
        words += ["--progress", "bar"]  # mpirun is no terminal
    begun = time.perf_counter()
    code = wait_for(words)
    if code:
        raise SystemExit(code)
    snapshots = SnapshotSet(folder)
    numbers = {
        "states": snapshots.states,
        "failed": len(snapshots.failures),
        "newton_iterations": snapshots.iterations,
        "ranks": ranks,
        "seconds": time.perf_counter() - begun,
    }
    return snapshots, numbers


def wait_for(words: list[str]) -> int:
    """Run mpirun; Ctrl-C interrupts it, too, and it is waited for."""
    with subprocess.Popen(words, stdout=subprocess.DEVNULL, env=os.environ | {CALLER: "demo"}) as job:
        try:
            return job.wait()
        except (SystemExit, KeyboardInterrupt):
            with contextlib.suppress(subprocess.TimeoutExpired):
                job.wait(timeout=3)
            job.terminate()  # if it is not of the foreground, and was not interrupted
            job.wait()
            if sys.stderr.isatty():
                print(SHOW_CURSOR, end="", file=sys.stderr)
            raise


def scene_file(name: str, out: Path, quick: bool) -> Path:
    """The file of one of the demo's scenes."""
    own = SCENES / f"{'plane' if name == 'plants' else name}.toml"
    changes = QUICK[name] if quick else {"plants": PLANTS}.get(name, {})
    if not changes:
        return own
    file = out / f"{name}.toml"
    file.write_text(sets.as_toml(load_scene(own).model_dump(mode="json", exclude_none=True) | changes))
    return file


def trained(out: Path, quick: bool) -> tuple[TouchedSegment, dict]:
    """Train the elements on all cores, measure the finger on held-out states of the fine mesh, save."""
    say("training: full-order states on a coarse mesh, on all cores")
    coarse, on_coarse = farm(scene_file("fine", out, quick), out / "coarse", "--coarse")
    say("training: the same states on a fine mesh; each begins at the coarse one")
    fine, on_fine = farm(scene_file("fine", out, quick), out / "fine", "--near", str(out / "coarse"))
    say("held-out: full-order states before a plane, on the coarse mesh from rest, then on the fine one")
    drawn = f"--random {QUICK_HELD_OUT if quick else HELD_OUT} --distances 4 --seed 2018".split()
    farm(scene_file("plane_coarse", out, quick), out / "heldout-coarse", *drawn)
    near = "--near", str(out / "heldout-coarse")
    fresh, held_out = farm(scene_file("plane", out, quick), out / "heldout", *drawn, *near)
    say("the finger: fit its elements to the fine states, assemble it, compare it with the held-out ones")
    with steps() as progress:
        states = read_section_states(fine)
        rod = Rod(elements=train(states, origin(fine), progress), scene=states.scene)
        rod = rod.with_accuracy(check(rod, fresh, progress))
    rod.save(out / "finger.h5")
    touched = before_plane(Rod.load(out / "finger.h5"), fresh)
    sets_ = {"coarse": coarse, "fine": fine}
    return touched, {
        "coarse": on_coarse,
        "fine": on_fine,
        "heldout": held_out,
        "meshes": {name: one.description.scene["mesh"] for name, one in sets_.items()},
        "unknowns": {name: 3 * len(one.nodes) for name, one in sets_.items()},
        "elements": [piece.kind for piece in reversed(rod.pieces[0])],
        "terms": sum(len(law.polynomial.powers) for law in rod.elements.laws.values()),
        "bytes": (out / "finger.h5").stat().st_size,
        "left_out": rod.elements.provenance["left_out"],
        "errors": rod.accuracy,
        "parity": report.parity(touched, fresh, out / "parity.png"),
    }


def grasp(model: Model, full_order: FingerModel, out: Path) -> tuple[Grasp, dict]:
    """Three full-order fingers around an object of unknown position; every final state solved again from rest."""
    say("grasp: three full-order fingers, driven by its controller")
    gripper = Gripper(model)
    true = gripper.distances(OBJECT_CENTRE, OBJECT_RADIUS)
    with steps() as progress:
        number = count()
        plants = [Shown(full_order, float(distance), number, progress) for distance in true]
        result = gripper.grasp(TARGET, plants)
        verified = [Shown(full_order, float(distance), number, progress) for distance in true]
        forces = [plant.pull(tensions) for plant, tensions in zip(verified, result.tensions, strict=True)]
    report.history(result, TARGET, model.lead, out / "grasp.png")
    numbers = result.as_json() | {
        "target": TARGET,
        "true_distances": true.tolist(),
        "true_centre": list(OBJECT_CENTRE),
        "true_radius": OBJECT_RADIUS,
        "verified_forces": forces,
        "force_errors": [abs(force / TARGET - 1) for force in forces],
        "distance_errors": np.abs(result.distances - true).tolist(),
        "centre_error": float(np.linalg.norm(result.centre - OBJECT_CENTRE)),
        "full_order_solves": sum(plant.solves for plant in plants),
        "history": [asdict(pull) for pull in result.history],
    }
    return result, numbers


class Shown(FullOrderPlant):
    """A full-order finger whose pulls are counted on the screen."""

    def __init__(self, model: FingerModel, distance: float, count: Iterator[int], progress: Progress):
        super().__init__(model, distance)
        self._count, self._progress = count, progress

    def pull(self, tensions: ArrayLike) -> float:
        """Contact force [N] at these tensions [N]."""
        self._progress("full-order states", next(self._count), 0)
        return super().pull(tensions)


def single_finger(model: Model, full_order: FingerModel, progress: Progress) -> dict:
    """Hold without feedback at known distances, reach a point: each answer evaluated by the full-order model."""
    finger, holds = Finger(model), []
    for k, distance in enumerate(HOLD_DISTANCES):
        progress("hold and reach", k, len(HOLD_DISTANCES) + 1)
        motion = finger.hold(TARGET, distance)
        force = FullOrderPlant(full_order, distance).pull(motion.tensions)
        holds.append(motion.as_json() | {"distance": distance, "verified_force": force})
        holds[-1]["force_error"] = abs(force / TARGET - 1)
    goal = finger.rest + full_order.solve(GOAL, sensitivities=False).tip
    motion, far = finger.reach(goal.tolist()), finger.reach(FAR)
    arrived = finger.rest + full_order.solve(motion.tensions, sensitivities=False).tip
    progress("hold and reach", len(HOLD_DISTANCES) + 1, len(HOLD_DISTANCES) + 1)
    return {
        "holds": holds,
        "reach": motion.as_json() | {"goal": goal.tolist(), "verified_miss": float(np.linalg.norm(arrived - goal))},
        "unreachable": far.as_json() | {"goal": FAR},
    }


def pictures(full_order: FingerModel, picture: Path, progress: Progress) -> None:
    """Solve and draw the cases."""
    states = []
    for k, (tensions, distance) in enumerate(CASES):
        progress("pictures", k, len(CASES))
        states.append(full_order.solve(tensions, distance, sensitivities=False))
    draw([Deformed.of(full_order, state) for state in states], picture)
    progress("pictures", len(CASES), len(CASES))


def main(out: Path, quick: bool = False) -> None:
    """Run all of it."""
    begun = time.perf_counter()
    out.mkdir(parents=True, exist_ok=True)
    model, numbers = trained(out, quick)
    scene = load_scene(scene_file("plants", out, quick))
    full_order = FingerModel(scene)
    result, numbers["grasp"] = grasp(model, full_order, out)
    say(f"one finger: hold and reach, verified; the authors' sweep of {HOLDS:,} holds; pictures")
    with steps() as progress:
        numbers |= single_finger(model, full_order, progress)
        numbers["campaign"] = campaign.run(model, HOLDS, TARGET, sweep=True, progress=progress).as_json()
        pictures(full_order, out / "s11.png", progress)
    numbers["scene"] = scene.model_dump(mode="json")
    numbers["seconds"] = time.perf_counter() - begun
    (out / "report.json").write_text(json.dumps(numbers, indent=1))
    write_page(model, out / "finger.html")
    (out / "report.html").write_text(report.render("demo.html.j2", numbers))
    held = [*numbers["grasp"]["force_errors"], *[hold["force_error"] for hold in numbers["holds"]]]
    forces, touch = (numbers["errors"][name] for name in ("contact_force", "touch"))
    say(
        f"contact force: median error {forces['median']:.2%} on held-out states of the fine mesh; "
        f"touch decided correctly: {touch['right']:.1%}; worst held force off by {max(held):.2%}"
    )
    say(f"report: {out / 'report.html'}; the finger to play with, in a browser: {out / 'finger.html'}")
    if not result.converged:
        raise SystemExit(3)


def say(line: str) -> None:
    """Print a line of the demo."""
    terminal.say(f"demo: {line}")


if __name__ == "__main__":
    words = [word for word in sys.argv[1:] if word != "--quick"]
    main(Path(words[0] if words else "out/demo"), quick="--quick" in sys.argv)
