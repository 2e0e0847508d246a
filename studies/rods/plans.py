"""The sets of pressed states that the study trains elements on, and the fingers assembled from them."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, replace
from pathlib import Path

from rom.dataset.snapshot_set import SnapshotSet
from rom.elements.fitting.degrees import HIGHEST
from rom.elements.fitting.training import train
from rom.elements.samples.section_states import read_section_states
from rom.rod.rod import Rod
from rom.summaries import origin
from studies import sets
from studies.parts import Run

SEED = 5
WALL = 1e-6  # range of a tension at a wall [N]
ON_A_WALL = 25  # states


@dataclass(frozen=True)
class Plan:
    """A set: the largest force [N], lines of 5 states, held-out states; mesh, offsets (y, z) of tendons [m], degree."""

    force: float
    lines: int
    held_out: int
    mesh: tuple[int, int, int] | None = None
    offsets: tuple[tuple[float, float], ...] | None = None
    degree: float = HIGHEST

    @property
    def name(self) -> str:
        """Name of the plan in files and tables."""
        mesh = "" if self.mesh is None else f", {self.mesh[0]} x {self.mesh[1]} order {self.mesh[2]}"
        return f"{self.force:g} N{mesh}{'' if self.offsets is None else f', {len(self.offsets)} tendons'}"


SMALL, LARGE = Plan(5.0, 24, 100), Plan(15.0, 24, 100)
HIGHER = replace(LARGE, degree=6.0)
FINE = Plan(15.0, 12, 20, sets.STANDARD)


def scene(run: Run, plan: Plan) -> Path:
    """The draft finger with a load in place of the plane."""
    table = sets.draft_table(plan.mesh) | {"load": {"force": plan.force}, "sampling": {"lines": plan.lines}}
    del table["obstacle"]
    if plan.offsets is not None:
        table["tendons"] = [
            {"name": f"F{k}", "offset": list(offset), "segment": 1, "tension": [0.0, 100.0]}
            for k, offset in enumerate(plan.offsets, 1)
        ]
    return sets.written(run.sets, f"pressed {plan.name} {plan.lines} lines", sets.as_toml(table))


def snapshots(run: Run, plan: Plan, lines: int | None = None) -> SnapshotSet:
    """The training set, or its first lines."""
    whole = sets.training(scene(run, plan))
    return whole.only([f"pressed-{k}" for k in range(plan.lines if lines is None else lines)])


def held_out(run: Run, plan: Plan) -> SnapshotSet:
    """Held-out pressed states."""
    file = scene(run, plan)
    place = file.with_suffix("") / "held-out"
    sets.farm(2, file, place, "--random", str(plan.held_out), "--seed", str(SEED))
    return SnapshotSet(place)


def on_walls(run: Run, plan: Plan) -> list[SnapshotSet]:
    """Held-out pressed states with one tension at its lowest or highest, a set for each."""
    found, table = [], tomllib.loads(scene(run, plan).read_text())
    for k, tendon in enumerate(table["tendons"]):
        lower, upper = tendon["tension"]
        for name, wall in (("lowest", [lower, lower + WALL]), ("highest", [upper - WALL, upper])):
            tendons = [one | ({"tension": wall} if one is tendon else {}) for one in table["tendons"]]
            text = sets.as_toml(table | {"tendons": tendons})
            file = sets.written(run.sets, f"pressed {plan.name} F{k + 1} {name}", text)
            sets.farm(2, file, file.with_suffix(""), "--random", str(ON_A_WALL), "--seed", str(SEED))
            found.append(SnapshotSet(file.with_suffix("")))
    return found


def trained(training: SnapshotSet, degree: float = HIGHEST) -> Rod:
    """The finger of a set's own elements."""
    states = read_section_states(training)
    return Rod(elements=train(states, origin(training), highest=degree), scene=states.scene)


def rod(run: Run, plan: Plan) -> Rod:
    """The finger of all lines, from its file if it has one."""
    file = scene(run, plan).with_suffix(f".{plan.degree:g}.h5")
    if not file.exists():
        trained(snapshots(run, plan), plan.degree).save(file)
    return Rod.load(file)
