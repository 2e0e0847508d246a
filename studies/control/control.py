"""The controllers measured: campaigns, dense search, loop, grasps, and held answers fed to the full-order model.

python3 studies/control/control.py [OUT] [--quick]    prints a table, writes OUT/control.json (out/control by default)

Models are trained from the sets of the surrogate's study (out/surrogate), which are solved if they are not there.
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

from control import Flaws, Gripper, Limits, SimulatedPlant, campaign
from control.least_squares import CONVERGED, STATIONARY
from control.loop import run
from control.plant import Dead, Plant, Slipping
from rom import Surrogate
from rom.build import train
from rom.error_model import calibrated
from rom.separation.alternating_directions import EnrichmentOptions
from studies import sets
from studies.control import grasps, verification
from studies.surrogate import growth

TARGET = 1.0  # [N]
PAPER_US = {
    "one segment": 7160.0,
    "two segments": 30000.0,
    "two segments, both pairs": 30000.0,
}  # Chenevier et al., table 1
GRID = 40_000  # points of a dense search
CROSSINGS = 45  # bisections
DISTANCES = 0.010, 0.012, 0.008  # [m] of the planes before the loop's fingers


def model(name: str, folder: Path, surrogates: Path) -> Surrogate:
    """A trained model, from its file if it is there; its states are in the folder of the surrogates' sets."""
    file = folder / f"{name.replace(', ', '-').replace(' ', '-')}.h5"
    if not file.exists():
        surrogates.mkdir(parents=True, exist_ok=True)
        if name == "two segments, both pairs":
            scene, scaling = growth.scene(surrogates, 5), "fresh"
        else:
            scene, scaling = sets.scene(surrogates, {"one segment": "draft"}.get(name, name)), "scaling"
        states = sets.training(scene)
        drawn = sets.SCALING if scaling == "scaling" else (growth.FRESH[5], growth.SEED)
        held_out = sets.held_out(scene, scaling, *drawn)
        calibrated(train(states, EnrichmentOptions()), held_out).save(file)
    return Surrogate.load(file)


def dense_search(surrogate: Surrogate, found: campaign.Campaign) -> dict:
    """Every answer that is called unreachable, sought on a grid of tensions, and along its edges that cross the target.

    A fitted force may jump where regimes meet; an edge across a jump crosses the target without ever holding it.
    """
    lower, upper = found.lower, found.upper
    nodes = round(GRID ** (1 / len(lower)))
    axes = [np.linspace(low, high, nodes) for low, high in zip(lower, upper, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)

    def force(tensions: np.ndarray, distance: float) -> np.ndarray:
        points = np.column_stack([tensions.reshape(-1, len(lower)), np.full(tensions[..., 0].size, distance)])
        return np.asarray(surrogate.evaluate(points).contact_force).reshape(tensions.shape[:-1])

    flagged = np.flatnonzero(found.status == STATIONARY)
    wrong, jumps, target = 0, 0, found.contact_force
    for i in flagged:
        distance = float(found.distances[i])
        here = force(grid, distance)
        if here.max() < target:
            continue
        missed = [np.inf]
        for axis in range(len(lower)):
            forces, points = np.moveaxis(here, axis, 0) - target, np.moveaxis(grid, axis, 0)
            crossing = forces[:-1] * forces[1:] < 0
            begin, end, sign = points[:-1][crossing], points[1:][crossing], np.sign(forces[:-1][crossing])
            for _ in range(CROSSINGS):
                middle = (begin + end) / 2
                same = (np.sign(force(middle, distance) - target) == sign)[:, None]
                begin, end = np.where(same, middle, begin), np.where(same, end, middle)
            missed += np.abs(force((begin + end) / 2, distance) - target).tolist()
        wrong += min(missed) <= 1e-6
        jumps += min(missed) > 1e-6
    return {"flagged": len(flagged), "wrong": int(wrong), "jumps": int(jumps), "grid": nodes ** len(lower)}


def solves(surrogate: Surrogate, starts: int) -> dict:
    """Random starts and the authors' sweep, every flag looked at."""
    found = {}
    for name, sweep in (("random", False), ("sweep", True)):
        result = campaign.run(surrogate, starts, TARGET, sweep)
        assert np.all((result.status == CONVERGED) | (result.status == STATIONARY)), "neither converged nor unreachable"
        found[name] = result.as_json() | {"dense_search": dense_search(surrogate, result)}
    return found


def loop(surrogate: Surrogate, periods: int) -> dict:
    """Three fingers at 1 kHz, with a flawed sensor: closing, squeezing and holding."""
    gripper = Gripper(surrogate, limits=Limits(rate=500.0))
    options = gripper.options(TARGET, noise=0.01, delay=3)
    flaws = Flaws(noise=0.01, resolution=0.005, delay=3, force_error=0.05)

    def once(count: int) -> dict:
        plants = [SimulatedPlant(surrogate, d, flaws, seed=k) for k, d in enumerate(DISTANCES)]
        report = run(gripper.grips(TARGET, options), plants, count)
        return report.as_json() | {"forces": [plant.contact_force for plant in plants]}

    once(20)  # compile before the clock runs
    return once(periods)


def trouble(surrogate: Surrogate, picture: Path) -> list[tuple[int, int, str]]:
    """A target that jumps, a tendon that slips, a sensor that dies for a while: drawn, and what the loop said."""
    gripper = Gripper(surrogate, limits=Limits(rate=500.0))
    options = gripper.options(TARGET, noise=0.01, delay=3)
    flaws = Flaws(noise=0.01, resolution=0.005, delay=3, force_error=0.05)
    plants = [SimulatedPlant(surrogate, d, flaws, seed=k) for k, d in enumerate(DISTANCES)]
    broken: list[Plant] = [Slipping(plants[0], 0, 0.8, 1400), Dead(plants[1], 1800, 2100), plants[2]]
    forces: list[list[float]] = []

    def targets(k: int) -> list[float] | None:
        forces.append([plant.contact_force for plant in plants])
        return [1.5 * TARGET] * 3 if k == 1000 else None

    report = run(gripper.grips(TARGET, options), broken, 2500, targets)
    figure, (upper, lower) = plt.subplots(2, 1, figsize=(9, 5.5), sharex=True, constrained_layout=True)
    seconds = np.arange(2500) / 1000
    wanted = np.where(seconds < 1, TARGET, 1.5 * TARGET)
    for i, colour in enumerate(("C0", "C1", "C2")):
        upper.plot(seconds, report.felt[:, i], color=colour, lw=0.6, alpha=0.35)
        upper.plot(
            seconds,
            np.array(forces)[:, i],
            color=colour,
            lw=1.4,
            label=f"finger {i}, d = {1e3 * DISTANCES[i]:g} mm (thin: felt)",
        )
        lower.plot(seconds, report.tensions[:, i, surrogate.lead], color=colour, lw=1.4)
    upper.plot(seconds, wanted, color="0.3", lw=1, ls="--", label="target")
    for at, what in (
        (1.0, "target jumps"),
        (1.4, "tendon of 0 slips by 20 %"),
        (1.8, "sensor of 1 dead"),
        (2.1, "and back"),
    ):
        upper.axvline(at, color="0.7", lw=0.8)
        lower.axvline(at, color="0.7", lw=0.8)
        upper.text(at + 0.01, 0.06, what, fontsize=8, rotation=90, va="bottom")
    upper.set(ylabel="contact force [N]")
    upper.legend(frameon=False, fontsize=8, loc="upper left")
    lower.set(xlabel="time [s]", ylabel=f"tension of {surrogate.names[surrogate.lead]} [N]")
    figure.savefig(picture, dpi=110)
    plt.close(figure)
    return report.events


def table(numbers: dict) -> str:
    """The table that is printed."""
    columns = ("starts", "converged", "unreachable", "wrong", "mean us", "p99 us", "call p99", "paper us")
    rows = [f"{'scene':32s}" + "".join(f"{column:>12s}" for column in columns)]
    for name, found in numbers["campaigns"].items():
        for kind in ("random", "sweep"):
            one = found[kind]
            counts = (one["starts"], one["converged"], one["unreachable"], one["dense_search"]["wrong"])
            times = (one["mean_us"], one["p99_us"], one["call_p99_us"], PAPER_US[name])
            rows.append(
                f"{name + ', ' + kind:32s}" + "".join(f"{n:12d}" for n in counts) + "".join(f"{t:12.1f}" for t in times)
            )
    for name, one in numbers["verification"].items():
        rows.append(
            f"{name}: held forces off by {one['median']:.2%} (median), {one['max']:.2%} (largest) of "
            f"{one['cases'] - one['not_solved']} by the full-order model"
        )
    one = numbers["loop"]
    rows.append(
        f"1 kHz, three fingers: {one['share']:.1%} of the period (p99), {one['missed']} of {one['periods']} missed"
    )
    one = numbers["grasps"]
    rows.append(
        f"{one['grasps']} grasps: {one['held']} held, {one['dropped']} dropped, {one['crushed']} crushed, "
        f"{one['not_lifted']} not lifted, {one['out_of_reach']} out of reach, {one['refused']} refused"
    )
    return "\n".join(rows)


def main(folder: Path, quick: bool) -> None:
    """Measure all of it; what is there of models and full-order answers is not made again."""
    folder.mkdir(parents=True, exist_ok=True)
    names = ["one segment"] if quick else list(PAPER_US)
    surrogates = folder / "surrogate" if quick else ROOT / "out" / "surrogate"
    models = {name: model(name, folder, surrogates) for name in names}
    starts, count, cases = (1000, 50, 10) if quick else (10_000, 1000, 100)
    numbers: dict = {"target": TARGET, "paper_us": PAPER_US}
    numbers["campaigns"] = {name: solves(one, starts) for name, one in models.items()}
    numbers["loop"] = loop(models["one segment"], 1000 if quick else 20_000)
    numbers["trouble"] = trouble(models["one segment"], folder / "loop.png")
    done = grasps.campaign(models["one segment"], count, 2018)
    numbers["grasps"] = {name: value for name, value in done.items() if name != "each"}
    numbers["grasps"]["reasons"] = [one["reason"] for one in done["each"] if one["fate"] == "refused"][:5]
    numbers["verification"] = {}
    for name in names:
        file = folder / f"{name.replace(', ', '-').replace(' ', '-')}.h5"
        numbers["verification"][name] = verification.main(file, file.with_suffix(""), cases, 2018)
    (folder / "control.json").write_text(json.dumps(numbers, indent=1))
    print(table(numbers))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path, nargs="?", default=ROOT / "out" / "control")
    parser.add_argument("--quick", action="store_true")
    given = parser.parse_args()
    main(given.out, given.quick)
