"""The main job, end to end: train the draft finger, grasp with three fingers, verify with the full-order model, report.

python3 studies/demo.py [OUT]      writes OUT (out/demo by default); what is there already is not solved again
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from control import Finger, Gripper, campaign
from control.gripper import Grasp
from fingerfem import FingerModel, load_scene
from fingerfem.plant import FullOrderPlant
from fingerfem.render import Deformed, draw
from rom.enrichment import EnrichmentOptions
from rom.error_map import calibrated
from rom.errors import accuracy, check
from rom.snapshots import SnapshotSet
from rom.surrogate import Surrogate
from rom.training import train
from studies import report

SCENE = "scenes/draft.toml"
HELD_OUT, SEED = 200, 2018
CASES = [([50.0, 0.0], None), ([100.0, 0.0], None), ([50.0, 0.0], 0.005), ([60.0, 60.0], 0.008)]
TARGET = 1.0  # [N]
OBJECT_CENTRE, OBJECT_RADIUS = (0.002, -0.0015), 0.012  # [m]; the controller is told neither
HOLD_DISTANCES = [0.003, 0.006, 0.010, 0.014, 0.018]  # [m]


def farm(folder: Path, *options: str) -> tuple[SnapshotSet, dict]:
    """Solve a snapshot set on all cores."""
    cores = getattr(os, "process_cpu_count", os.cpu_count)()
    ranks = int(os.environ.get("FINGERFEM_RANKS") or cores or 1)
    command = ["mpirun", "-n", str(ranks), sys.executable, "-m", "fingerfem", "snapshots", SCENE, str(folder), *options]
    if sys.stderr.isatty():
        command += ["--progress", "bar"]  # mpirun is no terminal
    begun = time.perf_counter()
    code = subprocess.run(command, stdout=subprocess.DEVNULL).returncode
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


def surrogate(out: Path) -> tuple[Surrogate, dict]:
    """Train on all cores, measure on fresh full-order states, save."""
    say("training: full-order states on all cores")
    snapshots, training = farm(out / "training")
    say("held-out: fresh full-order states at random parameters")
    fresh, held_out = farm(out / "heldout", "--random", str(HELD_OUT), "--seed", str(SEED))
    say("separating the snapshots")
    begun = time.perf_counter()
    model = train(snapshots, EnrichmentOptions())
    separation = time.perf_counter() - begun
    errors = check(model, fresh)
    model = calibrated(replace(model, accuracy=accuracy(errors)), fresh)
    model.save(out / "finger.h5")
    numbers = {
        "training": training,
        "heldout": held_out,
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
    plants = [FullOrderPlant(full_order, float(distance)) for distance in true]
    result = gripper.grasp(TARGET, plants)
    forces = [FullOrderPlant(full_order, float(d)).pull(t) for d, t in zip(true, result.tensions, strict=True)]
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


def single_finger(model: Surrogate, full_order: FingerModel) -> dict:
    """Hold without feedback at known distances, reach a point: each answer fed to the full-order model."""
    say("one finger: hold and reach, verified")
    finger = Finger(model)
    holds = []
    for distance in HOLD_DISTANCES:
        motion = finger.hold(TARGET, distance)
        force = full_order.solve(motion.tensions.tolist(), distance, sensitivities=False).contact_force
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
    goal = finger.rest + full_order.solve([35.0, 25.0], sensitivities=False).tip
    motion = finger.reach(goal.tolist())
    arrived = finger.rest + full_order.solve(motion.tensions.tolist(), sensitivities=False).tip
    far = finger.reach([0.0, 0.2, 0.0])
    return {
        "holds": holds,
        "reach": motion.as_json() | {"goal": goal.tolist(), "verified_miss": float(np.linalg.norm(arrived - goal))},
        "unreachable": {"goal": [0.0, 0.2, 0.0], "status": far.status, "tensions": far.tensions.tolist()},
    }


def main(out: Path) -> None:
    """Run all of it."""
    begun = time.perf_counter()
    out.mkdir(parents=True, exist_ok=True)
    scene = load_scene(SCENE)
    model, numbers = surrogate(out)
    full_order = FingerModel(scene)
    result, numbers["grasp"] = grasp(model, full_order, out)
    numbers |= single_finger(model, full_order)
    say("the authors' sweep: 10,000 holds")
    numbers["campaign"] = campaign.run(model, 10_000, TARGET, sweep=True).as_json()
    say("pictures")
    states = [full_order.solve(tensions, distance, sensitivities=False) for tensions, distance in CASES]
    draw([Deformed.of(full_order, state) for state in states], out / "s11.png")
    numbers["cases"] = [state.as_json() for state in states]
    numbers["scene"] = scene.model_dump(mode="json")
    numbers["unknowns"] = full_order.unknowns
    numbers["seconds"] = time.perf_counter() - begun
    (out / "report.json").write_text(json.dumps(numbers, indent=1))
    report.write(numbers, out / "report.html")
    held = [*numbers["grasp"]["force_errors"], *[hold["force_error"] for hold in numbers["holds"]]]
    say(
        f"contact force: median error {numbers['errors']['contact_force']['median']:.2%} on held-out states; "
        f"touch decisions right: {numbers['errors']['touch']['right']:.1%}; worst held force off by {max(held):.2%}"
    )
    say(f"report: {out / 'report.html'}")
    if not result.converged:
        raise SystemExit(3)


def say(line: str) -> None:
    """Tell what is going on."""
    print(f"demo: {line}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out/demo"))
