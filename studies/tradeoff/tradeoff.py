"""How far meshes are from a solution finer than all, at the same held-out states; and what models are measured against.

The same states on each mesh, against the reference's, are the error of the mesh (e_FEM of the paper's figure 9).
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

import numpy as np

from control import Finger
from control.model import Model
from rom.dataset.snapshot_set import SnapshotSet
from studies import sets
from studies.measures import quantiles
from studies.runner import Run
from studies.tradeoff.lattice import Lattice

SEED = 21
FELT = 0.1  # contact force that relative errors are of, at least [N]


@dataclass(frozen=True)
class Mesh:
    """The draft finger discretised: cells along and across, Lagrange order."""

    cells: tuple[int, int]
    order: int = 1

    @property
    def name(self) -> str:
        """For files and tables."""
        return f"{self.cells[0]} x {self.cells[1]} order {self.order}"


DRAFT, SQUARE, FINE = Mesh((20, 5)), Mesh((10, 5), 2), Mesh((24, 6), 2)


@dataclass(frozen=True)
class Plan:
    """What a study compares.

    Attributes:
        reference: mesh finer than all others.
        meshes: of which the error is measured.
        held_out: tensions, and distances of the plane at each.
        starts: of a campaign of solves.
    """

    reference: Mesh
    meshes: list[Mesh]
    held_out: tuple[int, int]
    starts: int


def full() -> Plan:
    """The whole study."""
    return Plan(Mesh(sets.REFERENCE[:2], sets.REFERENCE[2]), [DRAFT, SQUARE, FINE], (7, 3), 2000)


def quick() -> Plan:
    """A few states on coarse meshes."""
    return Plan(Mesh((20, 5), 2), [DRAFT, SQUARE], (4, 3), 1000)


@dataclass
class Study:
    """The sets of one plan."""

    run: Run
    plan: Plan

    def held_out(self, mesh: Mesh) -> SnapshotSet:
        """Held-out states on a mesh, the same parameters on all."""
        text = sets.on_mesh(sets.without_sampling("draft"), *mesh.cells, mesh.order)
        file = sets.written(self.run.folder, mesh.name, text)
        place, (tensions, distances) = file.with_suffix("") / "held-out", self.plan.held_out
        sets.farm(2, file, place, "--random", str(tensions), "--distances", str(distances), "--seed", str(SEED))
        return SnapshotSet(place)

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
    """The reference, and the error of every mesh."""
    study = Study(run, quick() if run.quick else full())
    meshes = [run.once(mesh.name, mesh_row, study, mesh) for mesh in study.plan.meshes]
    return {"reference": {"mesh": study.plan.reference.name, "unknowns": 3 * len(study.truth.nodes)}, "meshes": meshes}
