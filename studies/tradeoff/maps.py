"""Maps of the segment in the same trade: trained on one mesh, or on many states of a coarse and few of a fine one.

Contact is solved for online, so that a map is of no plane; here it answers for that of the surrogates.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from control import campaign
from fingerfem import load_scene
from rom import Rod, TouchedSegment
from rom.rod.objects import facing_plane
from rom.segment.training import build
from rom.snapshots.snapshot_set import SnapshotSet
from studies import sets
from studies.control.models import DISTANCES
from studies.measures import call_times, random_points
from studies.runner import ROOT, Run
from studies.tradeoff.tradeoff import DRAFT, SQUARE, Mesh, Study, costs, front, full, quick

FINE = Mesh((24, 6), 2)
PRESSED = ROOT / "scenes" / "demo" / "fine.toml"  # the draft scene's finger, which anything may press on


@dataclass(frozen=True)
class MapTraining:
    """A map: mesh and lines of states of its own, and of the coarse set that they correct, if any."""

    mesh: Mesh
    lines: int
    coarse: tuple[Mesh, int] | None = None

    @property
    def name(self) -> str:
        """For tables."""
        coarse = f", correcting {self.coarse[0].name}, {self.coarse[1]} lines" if self.coarse else ""
        return f"{self.mesh.name}, {self.lines} lines{coarse}"


FULL = [
    MapTraining(DRAFT, 56),
    MapTraining(SQUARE, 28),
    MapTraining(SQUARE, 4, (DRAFT, 20)),
    MapTraining(SQUARE, 8, (DRAFT, 28)),
    MapTraining(SQUARE, 16, (DRAFT, 56)),
    MapTraining(FINE, 4, (DRAFT, 28)),
    MapTraining(FINE, 8, (DRAFT, 40)),
    MapTraining(FINE, 16, (DRAFT, 56)),
    MapTraining(FINE, 32, (DRAFT, 112)),
]
QUICK = [MapTraining(DRAFT, 20), MapTraining(SQUARE, 4, (DRAFT, 20))]


@dataclass(frozen=True)
class Sets:
    """The sets that some maps are trained on: fewer lines are the first ones of the most that any map has of a mesh."""

    study: Study
    listed: list[MapTraining]

    def alone(self, mesh: Mesh, lines: int) -> SnapshotSet:
        """States of a mesh that were solved from rest."""
        most = max(
            [one.lines for one in self.listed if one.mesh == mesh and not one.coarse]
            + [one.coarse[1] for one in self.listed if one.coarse and one.coarse[0] == mesh]
        )
        return self._farmed(mesh, most, lines)

    def near(self, mesh: Mesh, lines: int, coarse: Mesh) -> SnapshotSet:
        """States of a mesh that begin at those of a coarser one."""
        most = max(one.lines for one in self.listed if one.mesh == mesh and one.coarse and one.coarse[0] == coarse)
        return self._farmed(mesh, most, lines, self.alone(coarse, 1))

    def _farmed(self, mesh: Mesh, most: int, lines: int, begun: SnapshotSet | None = None) -> SnapshotSet:
        folder = self.study.run.folder
        place = folder / f"pressed {mesh.name}{' near' if begun else ''}".replace(" ", "-")
        table = load_scene(PRESSED).model_dump(mode="json", exclude_none=True, exclude={"coarse"})
        changes = {"mesh": {"cells": list(mesh.cells), "order": mesh.order}, "sampling": {"lines": most}}
        file = sets.written(folder, f"{place.name}-scene", sets.as_toml(table | changes))
        sets.farm(2, file, place, *(["--near", str(begun.path)] if begun else []))
        return SnapshotSet(place).only([f"pressed-{k}" for k in range(lines)])


def row(sets_: Sets, one: MapTraining) -> dict:
    """What a map costs and errs."""
    study, truth = sets_.study, sets_.study.truth
    if one.coarse is None:
        coarse, own = None, sets_.alone(one.mesh, one.lines)
    else:
        coarse, own = sets_.alone(*one.coarse), sets_.near(one.mesh, one.lines, one.coarse[0])
    file, trained = study.run.folder / "map.h5", [own, *([coarse] if coarse else [])]
    build.train(own, coarse=coarse).save(file)
    segment = Rod.load(file)
    model = TouchedSegment(segment=segment, obstacle=facing_plane(segment.scene["geometry"]["side"], DISTANCES))
    answers = model.evaluate(truth.parameters)
    inside = answers.inside
    points, force = truth.parameters[inside], answers.contact_force[inside]
    # Its field is on the nodes of the coarse mesh.
    nodes, order = trained[-1].nodes, (one.coarse[0] if one.coarse else one.mesh).order
    total = truth.against(points, force, [model.displacement(point) for point in points], nodes, order)
    solves = campaign.run(model, study.plan.starts, 1.0).as_json()
    return {
        "name": one.name,
        "training": asdict(one),
        **costs(trained),
        "terms": len(segment.pose.powers),
        "bytes": file.stat().st_size,
        "query_us": call_times(model.value_and_jacobian, random_points(model, 3000))["p50_us"],
        "solve_us": solves["mean_us"],
        "solves_failed": solves["failed"],
        "marked": int(np.sum(~inside)),
        "expected": segment.force_error,
        "total": total | {"held_force": truth.held(model)},
    }


def measure(run: Run) -> dict:
    """Maps, and which of them no other beats."""
    listed = QUICK if run.quick else FULL
    own = Sets(Study(run, quick() if run.quick else full()), listed)
    rows = [run.once(f"map {one.name}", row, own, one) for one in listed]
    return {"maps": rows, "front": front(rows, "core_seconds")}
