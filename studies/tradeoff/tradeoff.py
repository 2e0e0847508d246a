"""Speed against accuracy: what a model costs to train and to ask, and how far it is from a solution finer than all.

Meshes first: the same held-out states on each, against the reference's, are the error of the mesh (e_FEM of the paper's
figure 9). Then models, against held-out states on their own mesh (e_MOR), and against the reference.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from control import Finger, campaign
from control.model import Model
from rom.build import train
from rom.held_out import FELT
from rom.separated.alternating_directions import EnrichmentOptions
from rom.snapshots.snapshot_set import SnapshotSet
from rom.surrogate import Surrogate
from studies import sets
from studies.measures import call_times, quantiles, random_points
from studies.runner import ROOT, Run
from studies.tradeoff.lattice import Lattice

SEED = 21


@dataclass(frozen=True)
class Mesh:
    """The draft finger discretised: cells along and across, Lagrange order, contact method and its parameter."""

    cells: tuple[int, int]
    order: int = 1
    method: str = "penalty"
    stiffness: float | None = None

    @property
    def name(self) -> str:
        """For files and tables."""
        extra = "" if self.method == "penalty" else f" {self.method}"
        return f"{self.cells[0]} x {self.cells[1]} order {self.order}{extra}" + (
            f" {self.stiffness:g}" if self.stiffness else ""
        )


@dataclass(frozen=True)
class Training:
    """A model: its mesh, the sampling, the separation's tolerance, and the set it corrects, if any."""

    mesh: Mesh
    sampling: str
    tolerance: float = 3e-4
    coarse: tuple[Mesh, str] | None = None

    @property
    def name(self) -> str:
        """For tables."""
        coarse = f", correcting {self.coarse[0].name} {self.coarse[1]}" if self.coarse else ""
        return f"{self.mesh.name}, {self.sampling}{coarse}, {self.tolerance:g}"


@dataclass(frozen=True)
class Plan:
    """What a study compares.

    Attributes:
        reference: mesh finer than all others.
        meshes: of which the error is measured, and on how many of the held-out tensions.
        held_out: tensions, and distances of the plane at each.
        models: to be trained.
        starts: of a campaign of solves.
    """

    reference: Mesh
    meshes: dict[Mesh, int]
    held_out: tuple[int, int]
    models: list[Training]
    starts: int


SAMPLINGS = {
    "4 x 4": "tension_nodes = 4\ncontact_nodes = 4",  # the paper's four nodes a direction
    "10 lines": "lines = 10",
    "20 lines": "lines = 20",
    "30 lines": "lines = 30",
    "40 lines": "lines = 40",
    "80 lines": "lines = 80",
}
DRAFT, MIDDLE, PAPER = (Mesh(cells) for cells in ((20, 5), (40, 7), (100, 10)))
SHORT, SQUARE, SQUARES = Mesh((6, 5), 2), Mesh((10, 5), 2), Mesh((20, 5), 2)

PRESETS = {
    "draft": Training(DRAFT, "40 lines"),
    "standard": Training(SQUARE, "40 lines"),
    "fine": Training(SQUARES, "30 lines"),
}


def full() -> Plan:
    """The whole study."""
    tensions = 7
    meshes = dict.fromkeys([DRAFT, MIDDLE, PAPER, SHORT, SQUARE, SQUARES], tensions)
    methods = [Mesh((20, 5), 1, "nitsche"), Mesh((20, 5), 1, "penalty", 100.0)]
    models = [Training(DRAFT, sampling) for sampling in SAMPLINGS]
    models += [Training(SQUARE, f"{lines} lines") for lines in (20, 30, 40)]
    models += [Training(SQUARES, "20 lines"), PRESETS["fine"]]
    models += [Training(SQUARES, "10 lines", coarse=(SQUARE, "40 lines"))]
    models += [Training(DRAFT, "80 lines", tolerance=tolerance) for tolerance in (1e-1, 1e-2, 1e-3)]
    models += [Training(SQUARE, "40 lines", tolerance=1e-2)]
    # What takes longest has fewer states.
    meshes |= dict.fromkeys(methods, tensions) | {PAPER: 3}
    return Plan(Mesh(sets.REFERENCE[:2], sets.REFERENCE[2]), meshes, (tensions, 3), models, 2000)


def quick() -> Plan:
    """A few of each kind."""
    meshes = dict.fromkeys([DRAFT, SQUARE, Mesh((20, 5), 1, "nitsche")], 4)
    models = [
        Training(DRAFT, "4 x 4"),
        Training(DRAFT, "20 lines"),
        Training(DRAFT, "20 lines", tolerance=1e-3),
        Training(SQUARE, "10 lines", coarse=(DRAFT, "20 lines")),
    ]
    return Plan(SQUARES, meshes, (4, 3), models, 1000)


@dataclass
class Study:
    """The sets of one plan."""

    run: Run
    plan: Plan

    def scene(self, mesh: Mesh, sampling: str = "") -> Path:
        """A scene's file."""
        text = (ROOT / "scenes" / "draft.toml").read_text().split("[sampling]")[0]
        text = sets.on_mesh(text, *mesh.cells, mesh.order)
        method = f'method = "{mesh.method}"' + (f"\nstiffness = {mesh.stiffness}" if mesh.stiffness else "")
        text = text.replace('method = "penalty"', method)
        if sampling:
            text += f"\n[sampling]\n{SAMPLINGS[sampling]}\n"
        return sets.written(self.run.folder, f"{mesh.name} {sampling}".strip(), text)

    def held_out(self, mesh: Mesh) -> SnapshotSet:
        """Held-out states on a mesh, the same parameters on all."""
        file = self.scene(mesh)
        place, (most, distances) = file.with_suffix("") / "held-out", self.plan.held_out
        count = self.plan.meshes.get(mesh, most)
        sets.farm(2, file, place, "--random", str(count), "--distances", str(distances), "--seed", str(SEED))
        return SnapshotSet(place)

    def training(self, mesh: Mesh, sampling: str) -> SnapshotSet:
        """A training set; fewer lines are the first ones of the most that the plan has of a mesh."""
        if "lines" not in sampling:
            return sets.training(self.scene(mesh, sampling))
        wanted = [one for model in self.plan.models for one in ((model.mesh, model.sampling), model.coarse) if one]
        most = max(int(lines.split()[0]) for of, lines in wanted if of == mesh and "lines" in lines)
        shared = {(DRAFT, 80): "draft", (SQUARE, 40): "standard"}.get((mesh, most))
        file = sets.scene(self.run.sets, shared) if shared else self.scene(mesh, f"{most} lines")
        whole = sets.training(file)
        return sets.first_lines(whole, int(sampling.split()[0]))

    @cached_property
    def truth(self) -> Truth:
        """The reference's answers."""
        return Truth(self.held_out(self.plan.reference), self.plan.reference.order)


class Truth:
    """What the reference says at the held-out parameters."""

    def __init__(self, reference: SnapshotSet, order: int):
        self.parameters, self.force = reference.random("parameters"), reference.random("contact_force")
        self.touch, self.slopes = reference.random("touch_distance"), reference.random("contact_force_jacobian")
        self.nodes = reference.nodes
        lower, upper = reference.nodes.min(axis=0), reference.nodes.max(axis=0)
        self._lattice = Lattice(lower, upper)
        read = self._lattice.reader(reference.nodes, order)
        self.fields = np.array([read(field) for field in reference.random("displacement")])

    def against(self, parameters: np.ndarray, force: np.ndarray, fields: list, nodes: np.ndarray, order: int) -> dict:
        """Errors of forces, shape (n,), and fields on nodes, at some of its parameters, shape (n, p)."""
        rows = [int(np.abs(self.parameters - point).sum(axis=1).argmin()) for point in parameters]
        assert np.array_equal(self.parameters[rows], parameters), "states must be those of the reference"
        true, read = self.force[rows], self._lattice.reader(nodes, order)
        felt = true > FELT
        moved = [
            np.linalg.norm(read(f) - self.fields[k]) / np.linalg.norm(self.fields[k])
            for f, k in zip(fields, rows, strict=True)
        ]
        return {
            "displacement": quantiles(np.array(moved)),
            "contact_force": quantiles(np.abs(force - true)[felt] / true[felt]) | {"count": int(felt.sum())},
        }

    def held(self, model: Model) -> dict:
        """Error of contact forces that a model holds, by the reference's derivatives at the tensions it is asked near.

        The reference's own force is the target, its tensions the start; the model answers others, not far, and what
        the reference says there is its force plus derivative times way: the square of a small way is left out.
        """
        finger, off, unreachable = Finger(model), [], 0
        for point, force, slopes in zip(self.parameters, self.force, self.slopes, strict=True):
            if force <= FELT:
                continue
            motion = finger.hold(float(force), float(point[-1]), start=point[:-1])
            if not motion.converged:
                unreachable += 1
                continue
            off.append(abs(slopes[:-1] @ (motion.tensions - point[:-1])) / force)
        return quantiles(np.array(off)) | {"count": len(off), "unreachable": unreachable}


def mesh_row(study: Study, mesh: Mesh) -> dict:
    """What a mesh costs and errs."""
    own = study.held_out(mesh)
    points = own.random("parameters")
    fields = list(own.random("displacement"))
    found = study.truth.against(points, own.random("contact_force"), fields, own.nodes, mesh.order)
    return {
        "name": mesh.name,
        "mesh": asdict(mesh),
        "unknowns": 3 * len(own.nodes),
        "states": own.states,
        "failed": len(own.failures),
        "core_seconds": own.core_seconds,
        "iterations": own.iterations,
        "fem": found,
    }


def costs(trained: list[SnapshotSet]) -> dict:
    """What the sets of a model cost together."""
    return {
        "states": sum(part.states for part in trained),
        "failed": sum(len(part.failures) for part in trained),
        "core_seconds": sum(part.core_seconds for part in trained),
    }


def model_row(study: Study, one: Training) -> dict:
    """What a model costs and errs."""
    own = study.training(one.mesh, one.sampling)
    trained = [own, *([study.training(*one.coarse)] if one.coarse else [])]
    model = train(own, EnrichmentOptions(tolerance=one.tolerance), *trained[1:])
    file = study.run.folder / "model.h5"
    model.save(file)
    model = Surrogate.load(file)
    held_out, truth = study.held_out(one.mesh), study.truth
    points = held_out.random("parameters")
    force, moved = model.evaluate(points).contact_force, [model.displacement(point) for point in points]
    same = Truth(held_out, one.mesh.order).against(points, force, moved, model.nodes, one.mesh.order)
    solves = campaign.run(model, study.plan.starts, 1.0).as_json()
    return {
        "name": one.name,
        "training": asdict(one),
        **costs(trained),
        "terms": sum(model.terms.values()),
        "bytes": file.stat().st_size,
        "bytes_without_field": replace(model, displacements=None).bytes,
        "query_us": call_times(model.value_and_jacobian, random_points(model, 3000))["p50_us"],
        "solve_us": solves["mean_us"],
        "solves_failed": solves["failed"],
        "mor": same,
        "total": truth.against(points, force, moved, model.nodes, one.mesh.order) | {"held_force": truth.held(model)},
    }


def front(rows: list[dict], cost: str, worth: tuple[str, ...] = ("total", "contact_force", "p95")) -> list[str]:
    """Names of the rows that no other beats in both cost and error, cheapest first."""
    found, best = [], np.inf
    for row in sorted(rows, key=lambda row: (row[cost], error_of(row, worth))):
        if error_of(row, worth) < best:
            best = error_of(row, worth)
            found.append(row["name"])
    return found


def error_of(row: dict, worth: tuple[str, ...]) -> float:
    """A number within a row."""
    value: Any = row
    for key in worth:
        value = value[key]
    return float(value)


def measure(run: Run) -> dict:
    """Meshes, models, and which models no other beats."""
    study = Study(run, quick() if run.quick else full())
    meshes = [run.once(mesh.name, mesh_row, study, mesh) for mesh in study.plan.meshes]
    models = [run.once(one.name, model_row, study, one) for one in study.plan.models]
    reference = {"mesh": study.plan.reference.name, "unknowns": 3 * len(study.truth.nodes)}
    return {"reference": reference, "meshes": meshes, "models": models, "front": front(models, "core_seconds")}
