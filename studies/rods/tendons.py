"""Four tendons, with co-contraction: elements of a draft mesh, against held-out pressed states of it."""

from __future__ import annotations

from pathlib import Path

from rom.rod.check import check_pressed
from studies import sets
from studies.parts import Run
from studies.rods import plans

OFFSET, MOST, FORCE = 0.004, 100.0, 15.0  # of tendons from the axis [m], tension [N], force on the plate [N]
LINES, HELD_OUT = 64, 60
TENDON = '[[tendons]]\nname = "{}"\noffset = [{}, {}]\nsegment = 1\ntension = [0.0, {}]\n'


def scene(run: Run) -> Path:
    """The draft finger, pulled from all four sides."""
    head, rest = sets.without_sampling("draft").split("[[tendons]]", 1)
    sides = {"up": (OFFSET, 0.0), "down": (-OFFSET, 0.0), "left": (0.0, OFFSET), "right": (0.0, -OFFSET)}
    tendons = "\n".join(TENDON.format(name, y, z, MOST) for name, (y, z) in sides.items())
    mesh = rest[rest.index("[mesh]") :]
    text = f"{head}{tendons}\n[load]\nforce = {FORCE}\n\n{mesh}\n[sampling]\nlines = {LINES}\n"
    return sets.written(run.folder, "four", text)


def four(run: Run, lines: int) -> dict:
    """Cost and errors of a finger of the first lines."""
    file = scene(run)
    training = sets.training(file).only([f"pressed-{k}" for k in range(lines)])
    finger = plans.trained(training)
    checked = check_pressed(finger, sets.held_out(file, HELD_OUT))
    return {
        "lines": lines,
        "states": training.states,
        "core_seconds": training.core_seconds,
        "degrees": finger.elements.provenance["degrees"],
        "held_out": checked["contact_force"],
        "place_um": {key: 1e6 * checked["place_m"][key] for key in ("median", "p95", "max")},
        "covered": checked["covered"],
    }
