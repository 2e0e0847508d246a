"""The main job, end to end: train a finger, grasp with three of it, verify with the full-order model, report.

python3 studies/demo.py [OUT] [SCENE]      writes OUT (out/demo by default); what is there already is not solved again
"""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict, replace
from itertools import count
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from rom import terminal
from rom.interruption import interruptible

if __name__ == "__main__":  # before what takes seconds to import
    interruptible("demo: stopped by Ctrl-C: solved states are kept; run the same command again")

from control import Finger, Gripper, campaign
from control.gripper import Grasp
from fingerfem import FingerModel, State, load_scene
from fingerfem.certify import Certifier
from fingerfem.full_order_plant import FullOrderPlant
from fingerfem.output.pictures import Deformed, draw
from fingerfem.scene.presets import KEYS
from fingerfem.scene.scene import Scene
from rom.build import train
from rom.error_model import calibrated, with_mesh_error
from rom.held_out import accuracy, check, check_against, compared
from rom.separation.alternating_directions import EnrichmentOptions
from rom.snapshots.snapshot_set import SnapshotSet
from rom.surrogate import Surrogate
from rom.terminal import Progress, steps
from studies import report, sets

SCENE = "scenes/demo.toml"
CALLER = "FINGERFEM_CALLER"  # tells the farm that the demo says what is kept when it is stopped
SHOW_CURSOR = "\x1b[?25h"  # which a bar hides, and a killed rank does not bring back
# Held-out states: tensions, distances of the plane at each, seed. The first half calibrates, the other tests.
HELD_OUT, FEW = (200, 1, 2018), (24, 1, 2019)
FINER = {1: (10, 5), 2: (24, 6)}  # cells of order 2 of a finer mesh, by the order of the scene's own
CASES = [([50.0, 0.0], None), ([100.0, 0.0], None), ([50.0, 0.0], 0.005), ([60.0, 60.0], 0.008)]
TARGET = 1.0  # [N]
OBJECT_CENTRE, OBJECT_RADIUS = (0.002, -0.0015), 0.012  # [m]; the controller is told neither
HOLDS = 10_000  # of the sweep
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


def finer_scene(scene: Scene, file: Path) -> Path:
    """The same finger on a finer mesh."""
    table = scene.model_dump(mode="json", exclude_none=True)
    for chosen in (*KEYS, "expected"):
        table.pop(chosen, None)
    cells = list(FINER[scene.mesh.order])
    file.write_text(sets.as_toml(table | {"mesh": {"cells": cells, "order": 2}}))
    return file


def random(tensions: int, distances: int, seed: int, near: Path) -> list[str]:
    """Options of a held-out set."""
    return [*f"--random {tensions} --distances {distances} --seed {seed} --near".split(), str(near)]


def surrogate(file: str | Path, out: Path) -> tuple[Surrogate, dict]:
    """Train on all cores, measure on held-out states of this mesh and of a finer one, save."""
    say("training: full-order states on all cores")
    snapshots, training = farm(file, out / "training")
    say("held-out: full-order states at random parameters")
    near = out / "training"
    fresh, held_out = farm(file, out / "heldout", *random(*HELD_OUT, near))
    say("the mesh: the same few states on this mesh and on a finer one")
    same, _ = farm(file, out / "same", *random(*FEW, near))
    finer, on_finer = farm(finer_scene(load_scene(file), out / "finer.toml"), out / "finer", *random(*FEW, near))
    say("surrogate: fit the snapshots, separate them, check them against the held-out states")
    begun = time.perf_counter()
    with steps() as progress:
        model = train(snapshots, EnrichmentOptions(), progress=progress)
        separation = time.perf_counter() - begun
        model = calibrated(model, fresh)
        errors = check(model, fresh, progress)
        model = with_mesh_error(model, finer)
        total = check_against(model, finer, progress)
    model = replace(model, accuracy=accuracy(errors) | {"against_finer_mesh": accuracy(total)})
    model.save(out / "finger.h5")
    numbers = {
        "training": training,
        "heldout": held_out,
        "finer": on_finer,
        "mesh_errors": compared(same, finer),
        "total_errors": total,
        "separation_seconds": separation,
        "errors": errors,
        "parity": report.parity(model, fresh, out / "parity.png"),
    }
    return Surrogate.load(out / "finger.h5"), numbers


def grasp(model: Surrogate, full_order: FingerModel, out: Path) -> tuple[Grasp, dict]:
    """Three full-order fingers around an object of unknown position; every final state solved again from rest."""
    say("grasp: three full-order fingers, driven by the surrogate's controller")
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


def single_finger(model: Surrogate, progress: Progress) -> dict:
    """Hold without feedback at known distances, reach a point: each answer fed to the full-order model.

    It begins at the surrogate's field: whatever the surrogate says, it ends at an equilibrium of its own.
    """
    finger, total, certifier = Finger(model), len(HOLD_DISTANCES) + 1, Certifier(model)
    holds = []
    for k, distance in enumerate(HOLD_DISTANCES):
        progress("hold and reach", k, total)
        motion = finger.hold(TARGET, distance)
        force = certifier.certify(motion.tensions, distance).contact_force
        assert force is not None
        holds.append(
            {
                "distance": distance,
                "tensions": motion.tensions.tolist(),
                "status": motion.status,
                "verified_force": force,
                "force_error": abs(force / TARGET - 1),
            }
        )
    progress("hold and reach", total - 1, total)
    goal = finger.rest + certifier.certify([35.0, 25.0]).tip
    motion = finger.reach(goal.tolist())
    arrived = finger.rest + certifier.certify(motion.tensions).tip
    far = finger.reach([0.0, 0.2, 0.0])
    progress("hold and reach", total, total)
    return {
        "holds": holds,
        "reach": motion.as_json() | {"goal": goal.tolist(), "verified_miss": float(np.linalg.norm(arrived - goal))},
        "unreachable": {"goal": [0.0, 0.2, 0.0], "status": far.status, "tensions": far.tensions.tolist()},
    }


def pictures(full_order: FingerModel, picture: Path, progress: Progress) -> list[dict]:
    """Solve and draw the cases."""
    states: list[State] = []
    for tensions, distance in CASES:
        progress("pictures", len(states), len(CASES) + 1)
        states.append(full_order.solve(tensions, distance, sensitivities=False))
    progress("pictures", len(CASES), len(CASES) + 1)
    draw([Deformed.of(full_order, state) for state in states], picture)
    progress("pictures", len(CASES) + 1, len(CASES) + 1)
    return [state.as_json() for state in states]


def main(out: Path, file: str | Path = SCENE) -> None:
    """Run all of it."""
    begun = time.perf_counter()
    out.mkdir(parents=True, exist_ok=True)
    scene = load_scene(file)
    model, numbers = surrogate(file, out)
    full_order = FingerModel(scene)
    result, numbers["grasp"] = grasp(model, full_order, out)
    say(f"one finger: hold and reach, verified; the authors' sweep of {HOLDS:,} holds; pictures")
    with steps() as progress:
        numbers |= single_finger(model, progress)
        numbers["campaign"] = campaign.run(model, HOLDS, TARGET, sweep=True, progress=progress).as_json()
        numbers["cases"] = pictures(full_order, out / "s11.png", progress)
    numbers["scene"] = scene.model_dump(mode="json")
    numbers["unknowns"] = full_order.problem.unknowns
    numbers["seconds"] = time.perf_counter() - begun
    (out / "report.json").write_text(json.dumps(numbers, indent=1))
    report.write(numbers, out / "report.html")
    held = [*numbers["grasp"]["force_errors"], *[hold["force_error"] for hold in numbers["holds"]]]
    say(
        f"contact force: median error {numbers['errors']['contact_force']['median']:.2%} on held-out states; "
        f"touch decided correctly: {numbers['errors']['touch']['right']:.1%}; worst held force off by {max(held):.2%}"
    )
    say(
        f"with the mesh's error, against {report.mesh_name(numbers['total_errors']['mesh'])}: "
        f"median {numbers['total_errors']['contact_force']['median']:.2%}"
    )
    say(f"report: {out / 'report.html'}")
    if not result.converged:
        raise SystemExit(3)


def say(line: str) -> None:
    """Tell what is going on."""
    terminal.say(f"demo: {line}")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:] or ["out/demo"]))
