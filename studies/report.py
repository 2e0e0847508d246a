"""Report of the demo's numbers: pictures, tables, and the pages that templates make of them."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from control.grasping.gripper import Grasp
from rom.dataset.snapshot_set import SnapshotSet
from rom.rod.touched_segment import TouchedSegment
from studies.sections import percent, spread, templates

ERROR_HEADER = "relative error of", "states", "median, 95 %, largest", "within the estimate"
HOLD_HEADER = "held by", "d [mm]", "found [mm]", "F1, F2 [N]", "full-order force [N]", "error", "status"
NAMES = {"tip": "tip displacement", "touch_distance": "touch distance", "contact_force": "contact force"}


def parity(model: TouchedSegment, held_out: SnapshotSet, picture: Path) -> dict:
    """Contact force and touch distance of the model over those of the full-order model."""
    answer, force = model.evaluate(held_out.random("parameters")), held_out.random("contact_force")
    touch, touched = 1e3 * held_out.random("touch_distance"), force > 0
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4.2), layout="constrained")
    for axes, true, own in (
        (left, force[touched], answer.contact_force[touched]),
        (right, touch, 1e3 * answer.touch_distance),
    ):
        axes.axline((0, 0), slope=1, color="0.7", lw=1)
        axes.plot(true, own, "o", ms=4)
    left.set(title="contact force [N], held-out states", xlabel="full-order model", ylabel="assembled finger")
    right.set(title="touch distance [mm], held-out states", xlabel="full-order model")
    figure.savefig(picture, dpi=110)
    plt.close(figure)
    return {"contact_force": force.tolist(), "model_contact_force": np.asarray(answer.contact_force).tolist()}


def history(grasp: Grasp, target: float, lead: int, picture: Path) -> None:
    """Measured force and lead tension of every finger, pull by pull."""
    figure, (upper, lower) = plt.subplots(2, 1, figsize=(8, 6), sharex=True, layout="constrained")
    for finger in range(len(grasp.status)):
        pulls = [pull for pull in grasp.history if pull.finger == finger]
        time = [pull.time for pull in pulls]
        upper.plot(time, [pull.contact_force for pull in pulls], "o-", ms=4, label=f"finger {finger + 1}")
        lower.plot(time, [pull.tensions[lead] for pull in pulls], "o-", ms=4)
    upper.axhline(target, color="0.5", ls="--", lw=1, label="target")
    upper.set(ylabel="measured contact force [N]", title="Grasp of an object of unknown position")
    lower.set(ylabel="lead tension [N]", xlabel="pull")
    upper.legend()
    figure.savefig(picture, dpi=110)
    plt.close(figure)


def error_rows(numbers: dict) -> list[list[str]]:
    """Errors by quantity in held-out states; of the contact force also in left-out lines."""
    found, left_out = numbers["errors"], numbers["left_out"]["contact_force"]
    rows = [
        [title, str(found[key]["count"]), spread(found[key]), percent(found[key]["coverage"])]
        for key, title in NAMES.items()
    ]
    return [*rows, ["contact force, training states left out of the fit", str(left_out["count"]), spread(left_out), ""]]


def hold_rows(numbers: dict) -> list[list[str]]:
    """Every held force of the demo, by the full-order model."""
    grasp, names = numbers["grasp"], ("distances", "tensions", "verified_forces", "force_errors", "status")
    columns = zip(grasp["true_distances"], *(grasp[name] for name in names), strict=True)
    keys = ("distance", "tensions", "verified_force", "force_error", "status")
    holds = [[hold[key] for key in keys] for hold in numbers["holds"]]
    rows = [(f"grasp, finger {k}", *one) for k, one in enumerate(columns, 1)]
    rows += [("one finger, no feedback", distance, None, *rest) for distance, *rest in holds]
    return [
        [
            held_by,
            f"{1e3 * distance:.2f}",
            "given" if found is None else f"{1e3 * found:.2f}",
            ", ".join(f"{tension:.2f}" for tension in tensions),
            f"{force:.4f}",
            f"{error:.2%}",
            status,
        ]
        for held_by, distance, found, tensions, force, error, status in rows
    ]


def mesh_name(mesh: dict) -> str:
    """A mesh for people."""
    return f"{mesh['cells'][0]} x {mesh['cells'][1]} cells of order {mesh['order']}"


def render(template: str, numbers: dict) -> str:
    """A page, or a part of one, of the demo's numbers."""
    tables = {"errors": [ERROR_HEADER, *error_rows(numbers)], "holds": [HOLD_HEADER, *hold_rows(numbers)]}
    return templates().get_template(template).render(numbers | {"tables": tables, "mesh_name": mesh_name})
