"""Speed against accuracy: what a model costs to train and to ask, and how far it is from a solution finer than all.

python3 studies/tradeoff/tradeoff.py [OUT] [--quick]
    prints tables, writes OUT/tradeoff.json (out/tradeoff by default)

Meshes first: the same fresh states on each, against the reference's, are the error of the mesh (e_FEM of the paper's
figure 9). Then models, against fresh states on their own mesh (e_MOR), and against the reference. What is solved or
measured already is not done again; remove OUT to begin anew.
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from control import Finger, campaign
from rom.build import train
from rom.held_out import FELT
from rom.separation.alternating_directions import EnrichmentOptions
from rom.snapshots.files import write_whole
from rom.snapshots.snapshot_set import SnapshotSet
from rom.surrogate import Surrogate
from studies import sets
from studies.solver.solver import say
from studies.surrogate.surrogate import draw, quantiles, timed
from studies.tradeoff.lattice import Lattice
from studies.training.training import farm

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
    """A model: its mesh, the sampling of its training set, what becomes of it, and the set it corrects, if any."""

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
        meshes: of which the error is measured, and on how many of the fresh tensions.
        fresh: tensions, and distances of the plane at each.
        models: to be trained.
        starts: of a campaign of solves.
    """

    reference: Mesh
    meshes: dict[Mesh, int]
    fresh: tuple[int, int]
    models: list[Training]
    starts: int


SAMPLINGS = {
    "4 x 4": "tension_nodes = 4\ncontact_nodes = 4",  # the paper's four nodes a direction
    "5 x 6": "tension_nodes = 5\ncontact_nodes = 6",
    "7 x 9": "tension_nodes = 7\ncontact_nodes = 9",
    "9 x 12": "tension_nodes = 9\ncontact_nodes = 12",
    "10 lines": "lines = 10",
    "20 lines": "lines = 20",
    "40 lines": "lines = 40",
    "60 lines": "lines = 60",
}
DRAFT, MIDDLE, THIRD, PAPER, TWICE = (Mesh(cells) for cells in ((20, 5), (40, 7), (70, 8), (100, 10), (200, 20)))
SHORT, SQUARE, SQUARES = Mesh((6, 5), 2), Mesh((10, 5), 2), Mesh((20, 5), 2)

PRESETS = {
    "draft": Training(DRAFT, "40 lines"),
    "standard": Training(SQUARE, "60 lines"),
    "fine": Training(SQUARES, "60 lines"),
}


def full() -> Plan:
    """The whole study: some two hours on two cores."""
    few = 10
    meshes = dict.fromkeys([DRAFT, MIDDLE, THIRD, PAPER, SHORT, SQUARE, SQUARES], few)
    methods = [Mesh((20, 5), order, "nitsche") for order in (1, 2)]
    methods += [Mesh((20, 5), 1, "penalty", factor) for factor in (100.0, 1e5)]
    grids, few_lines = ["4 x 4", "5 x 6", "7 x 9", "9 x 12"], ["10 lines", "20 lines"]
    models = [Training(mesh, lines) for mesh in (DRAFT, SQUARE, SQUARES) for lines in ("40 lines", "60 lines")]
    models += [Training(mesh, "40 lines") for mesh in (SHORT, MIDDLE)]
    models += [
        Training(SQUARES, "10 lines", coarse=(SQUARE, "40 lines")),
        Training(SQUARES, "20 lines", coarse=(DRAFT, "60 lines")),
        Training(MIDDLE, "10 lines", coarse=(DRAFT, "9 x 12")),
    ]
    models += [Training(mesh, lines) for mesh in (DRAFT, SHORT, SQUARE) for lines in few_lines]
    models += [Training(DRAFT, sampling) for sampling in grids]
    models += [Training(SQUARE, "60 lines", tolerance=tolerance) for tolerance in (1e-2, 1e-3)]
    models += [Training(DRAFT, "9 x 12", tolerance=tolerance) for tolerance in (1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 1e-4)]
    models += [Training(PAPER, "20 lines")]
    return Plan(Mesh((40, 8), 2), meshes | dict.fromkeys(methods, few) | {TWICE: 2}, (few, 4), models, 5000)


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
    """The sets and numbers of one plan, in a folder."""

    folder: Path
    plan: Plan

    def scene(self, mesh: Mesh, sampling: str = "") -> Path:
        """A scene's file."""
        text = (ROOT / "scenes" / "draft.toml").read_text().split("[sampling]")[0]
        cells, order = f"cells = [{mesh.cells[0]}, {mesh.cells[1]}]", f"order = {mesh.order}"
        text = text.replace("cells = [20, 5]", cells).replace("order = 1", order)
        method = f'method = "{mesh.method}"' + (f"\nstiffness = {mesh.stiffness}" if mesh.stiffness else "")
        text = text.replace('method = "penalty"', method)
        if sampling:
            text += f"\n[sampling]\n{SAMPLINGS[sampling]}\n"
        return sets.written(self.folder, f"{mesh.name} {sampling}".strip(), text)

    def fresh(self, mesh: Mesh) -> SnapshotSet:
        """Fresh states on a mesh, the same parameters on all."""
        file = self.scene(mesh)
        place, (most, distances) = file.with_suffix("") / "fresh", self.plan.fresh
        count = self.plan.meshes.get(mesh, most)
        farm(2, file, place, "--random", str(count), "--distances", str(distances), "--seed", str(SEED))
        return SnapshotSet(place)

    def training(self, mesh: Mesh, sampling: str) -> SnapshotSet:
        """A training set."""
        return sets.training(self.scene(mesh, sampling))

    @cached_property
    def truth(self) -> Truth:
        """The reference's answers."""
        return Truth(self.fresh(self.plan.reference), self.plan.reference.order)


class Truth:
    """What the reference says at the fresh parameters."""

    def __init__(self, reference: SnapshotSet, order: int):
        self.parameters, self.force = reference.random("parameters"), reference.random("contact_force")
        self.touch, self.slopes = reference.random("touch_distance"), reference.random("contact_force_jacobian")
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

    def held(self, model: Surrogate) -> dict:
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


def seconds(of: SnapshotSet) -> float:
    """Core time that solving a set took [s]."""
    return float(sum(of.task(task)["seconds"] for task in of.plan.lines if task not in of.missing))


def mesh_row(study: Study, mesh: Mesh) -> dict:
    """What a mesh costs and errs."""
    own = study.fresh(mesh)
    points = own.random("parameters")
    fields = list(own.random("displacement"))
    found = study.truth.against(points, own.random("contact_force"), fields, own.nodes, mesh.order)
    return {
        "unknowns": 3 * len(own.nodes),
        "states": own.states,
        "failed": len(own.failures),
        "core_seconds": seconds(own),
        "iterations": own.iterations,
        "fem": found,
    }


def model_row(study: Study, one: Training) -> dict:
    """What a model costs and errs."""
    own = study.training(one.mesh, one.sampling)
    trained = [own, *([study.training(*one.coarse)] if one.coarse else [])]
    model = train(own, EnrichmentOptions(tolerance=one.tolerance), *trained[1:])
    file = study.folder / "model.h5"
    model.save(file)
    model = Surrogate.load(file)
    fresh, truth = study.fresh(one.mesh), study.truth
    points = fresh.random("parameters")
    force, moved = model.evaluate(points).contact_force, [model.displacement(point) for point in points]
    same = Truth(fresh, one.mesh.order).against(points, force, moved, model.nodes, one.mesh.order)
    solves = campaign.run(model, study.plan.starts, 1.0).as_json()
    return {
        "states": sum(part.states for part in trained),
        "failed": sum(len(part.failures) for part in trained),
        "core_seconds": sum(seconds(part) for part in trained),
        "terms": sum(model.terms.values()),
        "bytes": file.stat().st_size,
        "bytes_without_field": replace(model, displacements=None).bytes,
        "query_us": timed(model.value_and_jacobian, draw(model, 3000))["p50_us"],
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


def main() -> None:
    """Solve, train, measure, print, write; what is in the file already stays."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", nargs="?", help="out/tradeoff by default, out/tradeoff-quick if quick")
    parser.add_argument("--quick", action="store_true", help="few meshes and models")
    options = parser.parse_args()
    folder = Path(options.out or ROOT / "out" / ("tradeoff-quick" if options.quick else "tradeoff")).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    study, file = Study(folder, quick() if options.quick else full()), folder / "tradeoff.json"
    found: dict = json.loads(file.read_text()) if file.exists() else {"meshes": [], "models": []}

    def keep(part: str, name: str, row: dict) -> None:
        found[part].append({"name": name} | row)
        found["front"] = front(found["models"], "core_seconds")
        write_whole(file, lambda stream: stream.write(json.dumps(found, indent=1).encode()))
        say(found[part][-1])

    done = {row["name"] for part in ("meshes", "models") for row in found[part]}
    found["reference"] = {
        "mesh": study.plan.reference.name,
        "unknowns": 3 * len(study.fresh(study.plan.reference).nodes),
    }
    for mesh in study.plan.meshes:
        if mesh.name not in done:
            keep("meshes", mesh.name, {"mesh": asdict(mesh)} | mesh_row(study, mesh))
    for one in study.plan.models:
        if one.name not in done:
            keep("models", one.name, {"training": asdict(one)} | model_row(study, one))
    print("no other is both cheaper to train and nearer to the reference:")
    for name in found["front"]:
        row = next(row for row in found["models"] if row["name"] == name)
        print(f"  {row['core_seconds']:8.0f} s {100 * error_of(row, ('total', 'contact_force', 'p95')):8.3f} %  {name}")


if __name__ == "__main__":
    main()
