"""The maps that the study measures, each trained once."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from rom.rod.rod import Rod
from rom.segment.training import build
from rom.snapshots.snapshot_set import SnapshotSet
from studies import sets
from studies.runner import ROOT, Run

SEED = 5


@dataclass(frozen=True)
class Plan:
    """A map: the largest force [N], lines of states, terms, held-out states, and the mesh if not the draft scene's."""

    force: float
    lines: int
    terms: int
    held_out: int
    mesh: tuple[int, int, int] | None = None

    @property
    def name(self) -> str:
        """For files and tables."""
        mesh = "" if self.mesh is None else f", {self.mesh[0]} x {self.mesh[1]} order {self.mesh[2]}"
        return f"{self.force:g} N{mesh}"


SMALL, LARGE = Plan(5.0, 80, 1500, 150), Plan(15.0, 160, 4000, 150)
FINE = Plan(5.0, 30, 1000, 30, sets.STANDARD)
QUICK = Plan(5.0, 20, 300, 20)


def scene(run: Run, plan: Plan) -> Path:
    """The draft finger that something may press on instead of a plane."""
    text = (ROOT / "scenes" / "draft.toml").read_text().split("[sampling]")[0]
    head, rest = text.split("[obstacle]")
    text = f"{head}[load]\nforce = {plan.force}\n\n{rest[rest.index('[mesh]') :]}"
    if plan.mesh is not None:
        text = sets.on_mesh(text, *plan.mesh)
    return sets.written(run.folder, f"pressed {plan.name}", f"{text}\n[sampling]\nlines = {plan.lines}\n")


def snapshots(run: Run, plan: Plan) -> SnapshotSet:
    """The training set."""
    return sets.training(scene(run, plan))


def held_out(run: Run, plan: Plan) -> SnapshotSet:
    """Held-out states."""
    file = scene(run, plan)
    place = file.with_suffix("") / "held-out"
    sets.farm(2, file, place, "--random", str(plan.held_out), "--seed", str(SEED))
    return SnapshotSet(place)


def segment(run: Run, plan: Plan) -> Rod:
    """The map, from its file if it has one."""
    file = run.folder / f"{plan.name.replace(' ', '-')}.h5"
    if not file.exists():
        build.train(snapshots(run, plan), plan.terms).save(file)
    return Rod.load(file)
