"""What is held, fed to the full-order model: 100 held answers of a trained model, as figures 7 and 8 of the paper.

python3 studies/control/verification.py MODEL.h5 OUT [--cases 100] [--seed 2018]

Random starts, distances and contact forces; every answer that is converged is solved again by the full-order model of
the scene that the surrogate was trained on, from rest. Prints the errors, writes OUT/verification.json and its picture.
What is solved is not solved again by the next run.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from control import Finger
from fingerfem import FingerModel
from fingerfem.equilibrium.failures import LoadNotReached
from fingerfem.scene.scene import Scene
from rom import Surrogate
from rom.snapshots.files import write_whole

FORCES = 0.25, 4.0  # [N], two octaves on both sides of the paper's 1 N


def answers(model: Surrogate, cases: int, seed: int) -> list[dict]:
    """Held answers: `cases` that are converged, of random starts, distances and contact forces."""
    finger, (lower, upper) = Finger(model), model.limits
    random = np.random.default_rng(seed)
    found: list[dict] = []
    while len(found) < cases:
        *start, distance = lower + random.random(len(lower)) * (upper - lower)
        target = float(np.exp(random.uniform(*np.log(FORCES))))
        motion = finger.hold(target, float(distance), start=start)
        if motion.converged:
            point = [*motion.tensions, distance]
            found.append(
                {
                    "target": target,
                    "distance": float(distance),
                    "tensions": motion.tensions.tolist(),
                    "said_error": motion.error,
                    "tip": model.evaluate(point).tip.tolist(),
                }
            )
    return found


def verified(case: dict, full_order: FingerModel) -> dict:
    """A held answer with what the full-order model says of it; `force` is None where that found no equilibrium."""
    try:
        state = full_order.solve(case["tensions"], case["distance"], sensitivities=False)
    except LoadNotReached as error:
        return case | {"force": None, "reason": str(error)}
    return case | {
        "force": state.contact_force,
        "error": abs(state.contact_force / case["target"] - 1),
        "tip_error": float(np.linalg.norm(np.array(case["tip"]) - state.tip)),
        "full_order_tip": state.tip.tolist(),
    }


def summary(cases: list[dict]) -> dict:
    """Errors of the cases that the full-order model solved."""
    solved = [case for case in cases if case["force"] is not None]
    errors, tips = np.array([case["error"] for case in solved]), np.array([case["tip_error"] for case in solved])
    moved = np.array([np.linalg.norm(case["full_order_tip"]) for case in solved])
    off = np.array([abs(case["force"] - case["target"]) for case in solved])
    return {
        "cases": len(cases),
        "not_solved": len(cases) - len(solved),
        "median": float(np.median(errors)),
        "p95": float(np.percentile(errors, 95)),
        "max": float(errors.max()),
        "within_said": int(np.sum(off <= [case["said_error"] for case in solved])),
        "tip_median": float(np.median(tips / moved)),
        "tip_max": float(np.max(tips / moved)),
    }


def draw(cases: list[dict], numbers: dict, picture: Path) -> None:
    """Held against wanted, and the errors by distance."""
    solved = [case for case in cases if case["force"] is not None]
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2), constrained_layout=True)
    wanted = [case["target"] for case in solved]
    left.loglog(FORCES, FORCES, color="0.7", lw=1)
    left.loglog(wanted, [case["force"] for case in solved], "o", ms=4)
    left.set(
        xlabel="contact force wanted [N]", ylabel="held, by the full-order model [N]", title=f"{len(solved)} answers"
    )
    right.semilogy([1e3 * case["distance"] for case in solved], [100 * case["error"] for case in solved], "o", ms=4)
    right.axhline(100 * numbers["median"], color="0.4", lw=1, ls="--", label=f"median {numbers['median']:.2%}")
    right.axhline(100 * numbers["max"], color="0.4", lw=1, ls=":", label=f"largest {numbers['max']:.1%}")
    right.set(xlabel="distance of the plane [mm]", ylabel="error of the held force [%]")
    right.legend(frameon=False)
    figure.savefig(picture, dpi=120)
    plt.close(figure)


def write_json(file: Path, table: dict) -> None:
    """Write a file whole: a run that is killed leaves what the one before it had."""
    write_whole(file, lambda stream: stream.write(json.dumps(table, indent=1).encode()))


def main(model_file: Path, out: Path, cases: int, seed: int) -> dict:
    """Feed held answers to the full-order model, as far as this is not done yet."""
    out.mkdir(parents=True, exist_ok=True)
    model, results = Surrogate.load(model_file), out / "verification.json"
    wanted = answers(model, cases, seed)
    known = json.loads(results.read_text())["cases"] if results.exists() else []
    known = [case for case, want in zip(known, wanted, strict=False) if want.items() <= case.items()]
    full_order = FingerModel(Scene(**model.scene))
    for i in range(len(known), cases):
        known.append(verified(wanted[i], full_order))
        write_json(results, {"seed": seed, "cases": known})
        if (i + 1) % 10 == 0:
            print(f"{i + 1} of {cases} held answers solved again by the full-order model", flush=True)
    numbers = summary(known)
    write_json(results, numbers | {"seed": seed, "cases": known})
    draw(known, numbers, out / "verification.png")
    print(
        f"held forces, by the full-order model: error {numbers['median']:.2%} (median), {numbers['p95']:.2%} (95 %), "
        f"{numbers['max']:.2%} (largest) of {numbers['cases'] - numbers['not_solved']} answers"
    )
    return numbers


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("model", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--cases", type=int, default=100)
    parser.add_argument("--seed", type=int, default=2018)
    given = parser.parse_args()
    main(given.model, given.out, given.cases, given.seed)
