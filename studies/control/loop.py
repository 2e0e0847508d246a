"""Three fingers at 1 kHz with flawed sensors: the time that controllers take, and their response to disturbances."""

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
PERIODS = 20_000  # that are timed
FLAWS = Flaws(noise=0.01, resolution=0.005, delay=3, force_error=0.05)
JUMP, SLIP, DEAD, END = 1000, 1400, (1800, 2100), 2500  # periods of what disturbs them, and of the picture
EVENTS = {JUMP: "target jumps", SLIP: "tendon of 1 slips by 20 %", DEAD[0]: "sensor of 2 dead", DEAD[1]: "and back"}


def prepared(known: Model) -> tuple[list, list[SimulatedPlant]]:
    """Controllers that wait to close, and the fingers that they drive."""
    gripper = Gripper(known, limits=Limits(rate=500.0))
    grips = gripper.grips(TARGET, gripper.options(TARGET, noise=FLAWS.noise, delay=FLAWS.delay))
    return grips, [SimulatedPlant(known, d, FLAWS, seed=k) for k, d in enumerate(DISTANCES)]


def disturbed(known: Model, picture: Path) -> None:
    """Draw the response to a target that jumps, a tendon that slips, and a sensor that is dead for a while."""
    grips, plants = prepared(known)
    broken: list[Plant] = [Slipping(plants[0], 0, 0.8, SLIP), Dead(plants[1], *DEAD), plants[2]]
    forces: list[list[float]] = []

    def targets(k: int) -> list[float] | None:
        forces.append([plant.contact_force for plant in plants])
        return [1.5 * TARGET] * 3 if k == JUMP else None

    report = run_loop(grips, broken, END, targets)
    figure, (upper, lower) = plt.subplots(2, 1, figsize=(9, 5.5), sharex=True, layout="constrained")
    seconds = np.arange(END) / 1000
    upper.plot(seconds, report.felt, lw=0.6, alpha=0.35)
    upper.set_prop_cycle(None)
    upper.plot(
        seconds, forces, label=[f"finger {k + 1}, d = {1e3 * d:g} mm (thin: felt)" for k, d in enumerate(DISTANCES)]
    )
    upper.plot(seconds, np.where(seconds < JUMP / 1000, TARGET, 1.5 * TARGET), "k--", lw=1, label="target")
    lower.plot(seconds, report.tensions[:, :, known.lead])
    for period, words in EVENTS.items():
        upper.axvline(period / 1000, color="0.7", lw=0.8)
        lower.axvline(period / 1000, color="0.7", lw=0.8)
        upper.text(period / 1000 + 0.01, 0.06, words, fontsize=8, rotation=90, va="bottom")
    upper.set(ylabel="contact force [N]")
    upper.legend(frameon=False, fontsize=8, loc="upper left")
    lower.set(xlabel="time [s]", ylabel=f"tension of {known.parameters[known.lead].name} [N]")
    figure.savefig(picture, dpi=110)
    plt.close(figure)


def measure(run: Run) -> dict:
    """Times, and a picture of the response in the study's folder."""
    known = finger()
    disturbed(known, run.folder / "loop.png")
    return run_loop(*prepared(known), PERIODS).as_json()
