"""Free states, contact states and two segments, as figures 3, 4 and 6 of the paper; held forces, as figures 7 and 8."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from control import Finger
from fingerfem import load_scene
from fingerfem.output.sketch import write_sketch
from rom import TouchedSegment
from studies.axes import large_letters
from studies.parts import ROOT, Run

# Scene, and load cases that `fingerfem render` draws, by picture.
PICTURES = {
    "free": ("one_segment", ("F1=50", "F1=100", "F1=50 F2=50", "F1=100 F2=100")),
    "contact": ("one_segment", ("F1=50 d=0.005", "F1=100 d=0.005", "F1=50 F2=50 d=0.005", "F1=100 F2=50 d=0.015")),
    "two_segments": ("two_segments", ("F_l=40", "F_s=40", "F_s=20 F_l=20 d=0.03", "F_s=40 F_l=40 d=0.03")),
}
SKETCHED = ROOT / "scenes" / "one_segment.toml"
FORCES, DISTANCES = (0.5, 1.0, 2.0), np.linspace(0.001, 0.031, 121)  # held [N]; of the plane [m]


def picture(folder: Path, name: str) -> dict:
    """Render one into a folder."""
    scene, cases = PICTURES[name]
    words = [sys.executable, "-m", "fingerfem", "render", f"scenes/{scene}.toml", str(folder / f"{name}.png")]
    words += [word for case in cases for word in ("--case", case)]
    subprocess.run(words, cwd=ROOT, stdout=subprocess.DEVNULL, check=True)
    return {"scene": scene, "cases": list(cases)}


def sweep(finger: Finger, force: float) -> list[dict]:
    """Holds as the plane moves away: each begins at the tensions of the last that converged, the first at rest."""
    present, rows = finger.lower, []
    for distance in DISTANCES.tolist():
        motion = finger.hold(contact_force=force, distance=distance, start=present)
        present = motion.tensions if motion.converged else present
        rows.append(
            {"force": force, "distance": distance, "status": motion.status, "tensions": motion.tensions.tolist()}
        )
        rows[-1]["estimate"] = motion.error if motion.converged else np.nan
    return rows


def draw_held(rows: list[dict], names: list[str], file: Path) -> None:
    """Tensions above, the estimated error of the held force below, over the plane's distance."""
    large_letters()
    figure, (above, below) = plt.subplots(2, 1, figsize=(9, 7), sharex=True, layout="constrained")
    for colour, force in enumerate(FORCES):
        own = [row for row in rows if row["force"] == force]
        millimetres = [1e3 * row["distance"] for row in own]
        for k, dashes in enumerate("-:"):
            held = [row["tensions"][k] if row["status"] == "converged" else np.nan for row in own]
            above.plot(millimetres, held, f"C{colour}{dashes}", label=f"{names[k]}, {force:g} N")
        below.semilogy(millimetres, [100 * row["estimate"] / force for row in own], f"C{colour}")
    above.legend(ncols=len(FORCES))
    above.set(ylabel="tension [N]")
    below.set(xlabel="distance d of the plane [mm]", ylabel="estimated error [%]")
    figure.savefig(file, dpi=110)
    plt.close(figure)


def measure(run: Run) -> dict:
    """The cases of every picture, and the statuses of holds; pictures in the study's folder."""
    model = TouchedSegment.load()
    rows = [row for force in FORCES for row in sweep(Finger(model), force)]
    draw_held(rows, model.names[:-1], run.folder / "held.png")
    write_sketch(load_scene(SKETCHED), run.folder / "sketch.png")
    statuses = [row["status"] for row in rows]
    return {name: run.once(name, picture, run.folder, name) for name in PICTURES} | {
        "holds": {status: statuses.count(status) for status in ("converged", "unreachable", "out_of_domain")},
        "forces": list(FORCES),
    }
