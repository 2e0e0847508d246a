"""Three fingers at 1 kHz with flawed sensors: the time that controllers take, and what becomes of trouble."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from control import Flaws, Gripper, Limits, SimulatedPlant
from control.loop import run as run_loop
from control.model import Model
from control.plant import Dead, Plant, Slipping
from studies.control.models import TARGET, finger
from studies.parts import Run

DISTANCES = 0.010, 0.012, 0.008  # [m] of the planes before the fingers


def timed(known: Model, periods: int) -> dict:
    """Three fingers at 1 kHz, with a flawed sensor: closing, squeezing and holding."""
    gripper = Gripper(known, limits=Limits(rate=500.0))
    options = gripper.options(TARGET, noise=0.01, delay=3)
    flaws = Flaws(noise=0.01, resolution=0.005, delay=3, force_error=0.05)

    def once(count: int) -> dict:
        plants = [SimulatedPlant(known, d, flaws, seed=k) for k, d in enumerate(DISTANCES)]
        report = run_loop(gripper.grips(TARGET, options), plants, count)
        return report.as_json() | {"forces": [plant.contact_force for plant in plants]}

    once(20)  # compile before the clock runs
    return once(periods)


def trouble(known: Model, picture: Path) -> list[tuple[int, int, str]]:
    """A target that jumps, a tendon that slips, a sensor that dies for a while: drawn, and what the loop said."""
    gripper = Gripper(known, limits=Limits(rate=500.0))
    options = gripper.options(TARGET, noise=0.01, delay=3)
    flaws = Flaws(noise=0.01, resolution=0.005, delay=3, force_error=0.05)
    plants = [SimulatedPlant(known, d, flaws, seed=k) for k, d in enumerate(DISTANCES)]
    broken: list[Plant] = [Slipping(plants[0], 0, 0.8, 1400), Dead(plants[1], 1800, 2100), plants[2]]
    forces: list[list[float]] = []

    def targets(k: int) -> list[float] | None:
        forces.append([plant.contact_force for plant in plants])
        return [1.5 * TARGET] * 3 if k == 1000 else None

    report = run_loop(gripper.grips(TARGET, options), broken, 2500, targets)
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
        lower.plot(seconds, report.tensions[:, i, known.lead], color=colour, lw=1.4)
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
    lower.set(xlabel="time [s]", ylabel=f"tension of {known.parameters[known.lead].name} [N]")
    figure.savefig(picture, dpi=110)
    plt.close(figure)
    return report.events


def measure(run: Run) -> dict:
    """Times, and a picture of the trouble in the study's folder."""
    known = finger()
    events = trouble(known, run.folder / "loop.png")
    return timed(known, 20_000) | {"events": events}
