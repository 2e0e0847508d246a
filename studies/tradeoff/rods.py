"""Fingers of rod elements: cost against error, by mesh, number of lines and largest force.

They are trained on wrenches, on no plane; here they answer for the draft scene's. On meshes finer than the draft one
every state begins at the same state on that, whose cost counts, too.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from control import campaign
from fingerfem import load_scene
from rom import Rod, TouchedSegment
from rom.dataset.snapshot_set import SnapshotSet
from rom.elements.fitting.training import train
from rom.elements.samples.section_states import read_section_states
from rom.rod.objects.shapes import facing_plane
from rom.summaries import origin
from studies import sets
from studies.control.models import DISTANCES
from studies.measures import call_times, random_points
from studies.runner import ROOT, Run
from studies.tradeoff.tradeoff import DRAFT, FINE, SQUARE, Mesh, Study, costs, front, full, quick

PRESSED = ROOT / "scenes" / "demo" / "fine.toml"  # the draft scene's finger, which anything may press on
FORCE, SMALL = 15.0, 5.0  # largest on the plate [N]


@dataclass(frozen=True)
class RodTraining:
    """Elements: their mesh, lines of states, and the largest force [N]."""

    mesh: Mesh
    lines: int
    force: float = FORCE

    @property
    def name(self) -> str:
        """For tables."""
        return f"{self.mesh.name}, {self.lines} lines, {self.force:g} N"


FULL = [
    *(RodTraining(mesh, lines) for mesh in (DRAFT, SQUARE, FINE) for lines in (8, 16)),
    RodTraining(FINE, 32),
    RodTraining(SQUARE, 16, SMALL),
]
QUICK = [RodTraining(DRAFT, 8), RodTraining(SQUARE, 8)]


@dataclass(frozen=True)
class Sets:
    """The sets that elements are trained on: fewer lines are the first ones of the most of a mesh and force."""

    study: Study
    listed: list[RodTraining]

    def of(self, one: RodTraining) -> list[SnapshotSet]:
        """Its states, and those on the draft mesh where they begin, if that is another."""
        begun = [] if one.mesh == DRAFT else self.of(RodTraining(DRAFT, one.lines, one.force))
        most = max(other.lines for other in self.listed if other.force == one.force)
        folder = self.study.run.folder
        place = folder / f"pressed {one.mesh.name} {one.force:g}".replace(" ", "-")
        table = load_scene(PRESSED).model_dump(mode="json", exclude_none=True, exclude={"coarse"})
        table["load"]["force"] = one.force
        changes = {"mesh": {"cells": list(one.mesh.cells), "order": one.mesh.order}, "sampling": {"lines": most}}
        file = sets.written(folder, f"{place.name}-scene", sets.as_toml(table | changes))
        sets.farm(2, file, place, *(["--near", str(begun[0].path)] if begun else []))
        return [SnapshotSet(place).only([f"pressed-{k}" for k in range(one.lines)]), *begun]


def row(sets_: Sets, one: RodTraining) -> dict:
    """What a finger costs, and its errors."""
    study, truth, used = sets_.study, sets_.study.truth, sets_.of(one)
    states, file = read_section_states(used[0]), study.run.folder / "rod.h5"
    Rod(elements=train(states, origin(used[0])), scene=states.scene).save(file)
    finger = Rod.load(file)
    model = TouchedSegment(rod=finger, obstacle=facing_plane(finger.scene["geometry"]["side"], DISTANCES))
    answers = model.evaluate(truth.parameters)
    inside, nodes = answers.inside, used[0].nodes
    points, force = truth.parameters[inside], answers.contact_force[inside]
    fields = [model.displacement(point, nodes) for point in points]
    solves = campaign.run(model, study.plan.starts, 1.0).as_json()
    return {
        "name": one.name,
        "training": asdict(one),
        **costs(used),
        "states": used[0].states,
        "terms": sum(len(law.polynomial.powers) for law in finger.elements.laws.values()),
        "bytes": file.stat().st_size,
        "query_us": call_times(model.value_and_jacobian, random_points(model, 3000))["p50_us"],
        "solve_us": solves["mean_us"],
        "solves_failed": solves["failed"],
        "marked": int(np.sum(~inside)),
        "expected": finger.errors.contact_force,
        "total": truth.against(points, force, fields, nodes, one.mesh.order) | {"held_force": truth.held(model)},
    }


def measure(run: Run) -> dict:
    """Fingers, and which of those of the larger force no other beats; states of the reference are the study's."""
    listed = QUICK if run.quick else FULL
    own = Sets(Study(run, quick() if run.quick else full()), listed)
    rows = [run.once(f"rod {one.name}", row, own, one) for one in listed]
    return {"rods": rows, "front": front([row for row in rows if row["training"]["force"] == FORCE], "core_seconds")}
