"""One job on a snapshot set: what is asked for, checked, and done by the ranks of a communicator."""

import logging
import math
import time
from contextlib import nullcontext
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from mpi4py import MPI

from fingerfem.model import FingerModel
from fingerfem.scene.scene import Scene
from fingerfem.snapshots import task_queue
from fingerfem.snapshots.design import HeldOut, describe
from fingerfem.snapshots.given_points import GivenPoints
from fingerfem.snapshots.ledger import Ledger, sentence
from fingerfem.snapshots.lines.setting import Known
from fingerfem.snapshots.neighbours import KnownSet
from fingerfem.snapshots.progress import Reporter
from fingerfem.snapshots.reuse import Donor
from fingerfem.versions import versions
from rom.dataset.description import Description
from rom.dataset.folder import create, set_aside_broken_rounds, set_aside_strangers
from rom.dataset.plan import Round
from rom.dataset.snapshot_set import SnapshotSet
from rom.elements.fitting import growth


@dataclass(frozen=True, kw_only=True)
class Request:
    """Request for the states of a set.

    Attributes:
        scene: of the finger.
        folder: of the set; begun if new, finished if not.
        held_out: points to solve instead of training states.
        until: estimated relative error until which states are added, of a scene with a load [-].
        budget: time after which no further line is begun [s]; so long, states are added.
        reuse: folder of a set of the same finger whose states are taken.
        near: folder of a set at whose states held-out or pressed ones begin.
    """

    scene: Scene
    folder: Path
    held_out: HeldOut | GivenPoints | None = None
    until: float | None = None
    budget: float = math.inf
    reuse: Path | None = None
    near: Path | None = None

    def __post_init__(self) -> None:
        if self.until is not None and not 0 < self.until < 1:
            raise ValueError(f'until must be a share such as "1 %", above 0 and below 100 %, got {self.until:g}')
        if self.held_out is not None and (self.grows or self.reuse is not None):
            raise ValueError("random or points must not be given with until, budget or reuse, got both")
        if self.grows and self.scene.load is None:
            name, value = ("budget", self.budget) if self.until is None else ("until", self.until)
            raise ValueError(f"{name} must be left out for a scene without a load, got {value:g}")
        if self.scene.load is not None and self.reuse is not None:
            raise ValueError(f"reuse must be left out for a scene with a load, got {self.reuse}")
        if self.near is not None and self.held_out is None and self.scene.load is None:
            rule = "near must be left out for training states of a scene without a load"
            raise ValueError(f"{rule}, got {self.near}; add random or points")

    @property
    def grows(self) -> bool:
        """True if states are added as the error of the elements needs them."""
        return self.until is not None or math.isfinite(self.budget)


@dataclass(kw_only=True)
class Job:
    """A request in its folder, on the ranks of a communicator.

    Args:
        request: what is to be solved.
        world: the ranks.
        ranks_per_finger: how many of them solve one finger together.
    """

    request: Request
    world: MPI.Comm
    ranks_per_finger: int = 1
    description: Description = field(init=False)
    ledger: Ledger = field(init=False)

    def __post_init__(self) -> None:
        request, folder = self.request, self.request.folder
        self.description = describe(request.scene, versions(), request.held_out, request.grows)
        self._known = Known(
            donor=Donor(request.reuse, self.description) if request.reuse is not None else None,
            near=KnownSet(request.near, self.description) if request.near is not None else None,
        )
        create(folder, self.description)
        aside = set_aside_broken_rounds(folder, self.description)
        self.ledger = Ledger(folder, self.description)
        if self.is_first:
            for file in [*aside, *set_aside_strangers(folder, self.description)]:
                logging.warning(
                    "%s was not whole, or another set's: moved to %s and solved again", file, folder / "set-aside"
                )

    @property
    def is_first(self) -> bool:
        """True on the first rank, which reports."""
        return bool(self.world.rank == 0)

    def run(self, progress: str) -> dict[str, Any]:
        """Solve what is missing, and report how far that is in a style of `progress`.

        Returns, on the first rank, what came of it.
        """
        request, begun, work = self.request, time.perf_counter(), task_queue.Work()
        next_round = self._next_round if request.grows else None
        goal = task_queue.Goal(next_round=next_round, error=request.until or 0.0, seconds=request.budget)
        with Reporter(self.ledger, progress) if self.is_first else nullcontext(lambda: None) as report:
            if self.ledger.plan.missing() or (request.grows and not self.ledger.plan.ended(request.until or 0.0)):
                model = FingerModel(request.scene, self._group())
                work = task_queue.run(self.description, model, request.folder, report, goal, self._known)
        if not self.is_first:
            return {}
        self.ledger.refresh()
        summary = self.ledger.summary() | {
            "this_rank": asdict(work),
            "seconds": time.perf_counter() - begun,
            "ranks": self.world.size,
        }
        self._report(work, summary)
        return summary

    @property
    def is_unusable(self) -> bool:
        """True if states failed that a model needs: it can do without a held-out one, or one that was added."""
        needed = [task for task, *_ in self.ledger.failures if task in self.description.lines]
        return bool(needed) and not (self.request.held_out and self.ledger.summary()["solved"])

    def _next_round(self, error: float) -> Round:
        """Next round of lines that the set needs for a relative error [-]."""
        return growth.next_round(SnapshotSet(self.request.folder), error)

    def _group(self) -> MPI.Comm:
        count = self.ranks_per_finger
        return self.world.Split(self.world.rank // count) if count > 1 else MPI.COMM_SELF

    def _report(self, work: task_queue.Work, found: dict[str, Any]) -> None:
        for failure in self.ledger.failures:
            logging.warning("failed: %s", sentence(self.description, *failure))
        if self.ledger.failures:
            logging.warning("to try them again: python3 -m fingerfem retry %s, then this command", self.request.folder)
        rounds = self.ledger.plan.rounds
        if work.stopped:
            logging.warning("%s", work.stopped)
        elif self.request.grows and rounds and rounds[-1].finest:
            logging.warning("all states that may be added leave an estimated error of %.1e", found["estimated_error"])
        elif self.request.grows and rounds and rounds[-1].stalled:
            logging.warning(
                "an estimated error of %.1e is left: more states do not make it smaller, a finer mesh may",
                found["estimated_error"],
            )
