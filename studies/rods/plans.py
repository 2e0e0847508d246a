"""The sets of pressed states that the study trains elements on, and the fingers assembled from them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from rom.dataset.snapshot_set import SnapshotSet
from rom.elements.fitting.training import train
from rom.elements.samples.section_states import read_section_states
from rom.rod.rod import Rod
from rom.summaries import origin
from studies import sets
from studies.parts import Run

SEED = 5


@dataclass(frozen=True)
class Plan:
    """A set: the largest force [N], lines of 5 states, held-out states; mesh, and offsets (y, z) of tendons [m]."""

    force: float
    lines: int
    held_out: int
    mesh: tuple[int, int, int] | None = None
    offsets: tuple[tuple[float, float], ...] | None = None

    @property
    def name(self) -> str:
        """For files and tables."""
        mesh = "" if self.mesh is None else f", {self.mesh[0]} x {self.mesh[1]} order {self.mesh[2]}"
        return f"{self.force:g} N{mesh}{'' if self.offsets is None else f', {len(self.offsets)} tendons'}"


SMALL, LARGE = Plan(5.0, 24, 100), Plan(15.0, 24, 100)
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


def trained(training: SnapshotSet) -> Rod:
    """The finger of a set's own elements."""
    states = read_section_states(training)
    return Rod(elements=train(states, origin(training)), scene=states.scene)


def rod(run: Run, plan: Plan) -> Rod:
    """The finger of all lines, from its file if it has one."""
    file = scene(run, plan).with_suffix(".h5")
    if not file.exists():
        trained(snapshots(run, plan)).save(file)
    return Rod.load(file)
