"""The demo's report: pictures and a page, made from the numbers of report.json."""

from __future__ import annotations

from html import escape
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from control.grasping.gripper import Grasp
from rom.console.table import percent
from rom.dataset.snapshot_set import SnapshotSet
from rom.rod.touched_segment import TouchedSegment


def parity(model: TouchedSegment, held_out: SnapshotSet, picture: Path) -> dict:
    """Contact force and touch distance of the model over those of the full-order model."""
    points = held_out.random("parameters")
    answer, force, touch = model.evaluate(points), held_out.random("contact_force"), held_out.random("touch_distance")
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4.2), layout="constrained")
    for axes, truth, ours, unit, name in (
        (left, force[force > 0], answer.contact_force[force > 0], "N", "contact force"),
        (right, 1e3 * touch, 1e3 * answer.touch_distance, "mm", "touch distance"),
    ):
        axes.plot([0, truth.max()], [0, truth.max()], color="0.7", lw=1)
        axes.plot(truth, ours, "o", ms=4)  # a marked answer too: it is near
        axes.set(
            xlabel=f"full-order model [{unit}]", ylabel=f"assembled finger [{unit}]", title=f"{name}, held-out states"
        )
    figure.savefig(picture, dpi=110)
    plt.close(figure)
    return {"contact_force": force.tolist(), "model_contact_force": np.asarray(answer.contact_force).tolist()}


def history(grasp: Grasp, target: float, lead: int, picture: Path) -> None:
    """Force felt and lead tension of every finger, pull by pull."""
    figure, (upper, lower) = plt.subplots(2, 1, figsize=(8, 6), sharex=True, layout="constrained")
    for finger in range(len(grasp.status)):
        pulls = [pull for pull in grasp.history if pull.finger == finger]
        time = [pull.time for pull in pulls]
        forces = [pull.contact_force for pull in pulls]
        (line,) = upper.plot(time, forces, "o-", ms=4, label=f"finger {finger + 1}")
        lower.plot(time, [pull.tensions[lead] for pull in pulls], "o-", ms=4, color=line.get_color())
        if grasp.status[finger] == "converged":
            upper.plot(time[-1:], forces[-1:], "s", ms=10, mfc="none", color=line.get_color())
    upper.axhline(target, color="0.5", ls="--", lw=1, label="target")
    upper.set(ylabel="contact force felt [N]", title="Grasp of an object of unknown position (squares: held)")
    lower.set(ylabel="lead tension [N]", xlabel="pull")
    lower.xaxis.get_major_locator().set_params(integer=True)
    upper.legend()
    figure.savefig(picture, dpi=110)
    plt.close(figure)


def table(header: list[str], rows: list[list[str]]) -> str:
    """An HTML table."""
    head = "".join(f"<th>{escape(cell)}</th>" for cell in header)
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><tr>{head}</tr>{body}</table>"


def mesh_name(mesh: dict) -> str:
    """A mesh for people."""
    return f"{mesh['cells'][0]} x {mesh['cells'][1]} cells of order {mesh['order']}"


def error_rows(numbers: dict) -> list[list[str]]:
    """Error by quantity in held-out states; of the contact force also in the lines that were left out of the fits."""
    left_out, found = numbers["left_out"]["contact_force"], numbers["errors"]
    named = {"tip": "tip displacement", "touch_distance": "touch distance", "contact_force": "contact force"}
    rows = [
        [title, "held-out states", str(found[key]["count"]), *_spread(found[key]), percent(found[key]["coverage"])]
        for key, title in named.items()
    ]
    return [*rows, [named["contact_force"], "left-out lines", str(left_out["count"]), *_spread(left_out), ""]]


def _spread(row: dict) -> list[str]:
    return [percent(row[name]) for name in ("median", "p95", "max")]


ERROR_HEADER = ["relative error of", "in", "states", "median", "95th percentile", "largest", "within its estimate"]


def hold_rows(numbers: dict) -> list[list[str]]:
    """Every held force of the demo, as the full-order model feels it."""
    grasp = numbers["grasp"]
    rows = [
        [
            f"grasp, finger {k + 1}",
            f"{1e3 * true:.2f}",
            f"{1e3 * found:.2f}",
            _tensions(tensions),
            f"{force:.4f}",
            f"{error:.2%}",
            status,
        ]
        for k, (true, found, tensions, force, error, status) in enumerate(
            zip(
                grasp["true_distances"],
                grasp["distances"],
                grasp["tensions"],
                grasp["verified_forces"],
                grasp["force_errors"],
                grasp["status"],
                strict=True,
            )
        )
    ]
    return rows + [
        [
            "one finger, no feedback",
            f"{1e3 * hold['distance']:.2f}",
            "given",
            _tensions(hold["tensions"]),
            f"{hold['verified_force']:.4f}",
            f"{hold['force_error']:.2%}",
            hold["status"],
        ]
        for hold in numbers["holds"]
    ]


HOLD_HEADER = [
    "held by",
    "d [mm]",
    "d* found [mm]",
    "F1, F2 [N]",
    "full-order contact force [N]",
    "off target",
    "status",
]


def _tensions(values: list[float]) -> str:
    return ", ".join(f"{value:.2f}" for value in values)


def write(numbers: dict, page: Path) -> None:
    """Write the page; its pictures lie beside it."""
    grasp, coarse, fine, sweep = (numbers[name] for name in ("grasp", "coarse", "fine", "campaign"))
    reach, held_out = numbers["reach"], numbers["errors"]
    touch, contacts = held_out["touch"], held_out["contact_force"]
    page.write_text(f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>fingerfem: demo</title>
<style>body{{font:16px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em}} img{{max-width:100%}}
table{{border-collapse:collapse;margin:1em 0}} td,th{{border:1px solid #bbb;padding:.25em .6em;text-align:right}}
td:first-child,th:first-child{{text-align:left}}</style></head><body>
<h1>A rubber finger that reaches, touches and holds</h1>
<p>The finger is assembled from {len(numbers["elements"])} rod elements, {", ".join(numbers["elements"])}. They were trained on
{fine["states"]} full-order states on {mesh_name(numbers["meshes"]["fine"])} ({numbers["unknowns"]["fine"]:,} unknowns), each of which
began at the same state on {mesh_name(numbers["meshes"]["coarse"])}; {coarse["failed"] + fine["failed"]} failed. A controller used the finger to drive
three full-order fingers on a third mesh, {mesh_name(numbers["scene"]["mesh"])}, and that model verified every answer. The whole run
took {numbers["seconds"]:.0f} s.</p>
<h2>The finger</h2>
<img src="s11.png" alt="deformed finger, four load cases">
<p>Axial second Piola-Kirchhoff stress S11 of four load cases; the plate is grey, the obstacle tan. <a href="finger.html">Bend it yourself</a>: sliders
for the tensions and the plane, by the trained elements, in this browser.</p>
<h2>Errors</h2>
<p>Against {held_out["states"]} held-out states before a plane on the fine mesh; in {held_out["marked"]} of them rubber
touches, or the force is beyond what was trained: these answers are marked, and not counted. Contact forces above 0.1 N.</p>
{table(ERROR_HEADER, error_rows(numbers))}
<p>Touch is decided correctly in {touch["count"] - touch["wrong"]} of {touch["count"]} states ({touch["right"]:.1%}); contact force is compared
in the {contacts["count"]} states that touch. {numbers["terms"]:,} products; {numbers["bytes"] / 1e6:.1f} MB.</p>
<img src="parity.png" alt="assembled finger over full-order model">
<h2>Grasp</h2>
<p>Three fingers 120 degrees apart close around an object. They have neither its position nor its size: each feels contact, finds
d*, squeezes to {grasp["target"]:g} N and corrects by what it feels. Every pull is a full-order solve ({grasp["full_order_solves"]} in all).
The object's centre was found within {1e6 * grasp["centre_error"]:.0f} um.</p>
<img src="grasp.png" alt="force history">
{table(HOLD_HEADER, hold_rows(numbers))}
<p>"Full-order contact force" was solved again from rest at the final tensions. Without feedback the error is that of the elements and of the difference between the two meshes.</p>
<h2>Reach</h2>
<p>Goal ({", ".join(f"{1e3 * value:.2f}" for value in reach["goal"])}) mm: {reach["status"]}, verified miss
{1e6 * reach["verified_miss"]:.1f} um. A goal 200 mm away: {numbers["unreachable"]["status"]}.</p>
<h2>The authors' sweep</h2>
<p>{sweep["starts"]} holds of {sweep["contact_force"]:g} N over distances and starting tensions: {sweep["converged"]} converged,
{sweep["unreachable"]} unreachable and flagged, {sweep["failed"]} failed, {sweep["out_of_limits"]} out of limits. One call took {sweep["mean_us"]:.0f} us on average,
{sweep["p99_us"]:.0f} us at the 99th percentile, on the machine that made this page.</p>
<p>Every number of this page is in <a href="report.json">report.json</a>.</p>
</body></html>
""")
