"""The farm: ranks that solve a set's tasks without a master and without messages, and never lose one.

A finger is solved by one rank, or by a group of them whose first rank claims tasks and writes their files. The numbers
of a task do not depend on who solved it or in which order.
"""

import math
import time
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Self, TypeVar

from mpi4py import MPI

from fingerfem.model import FingerModel
from fingerfem.snapshots import ledger
from fingerfem.snapshots.claims import open_claims
from fingerfem.snapshots.design import body
from fingerfem.snapshots.lines.setting import NOTHING_KNOWN, Arrays, Known
from fingerfem.snapshots.lines.solver import LineSolver
from rom.dataset.plan import Plan, Round
from rom.dataset.snapshot_set import Description, SnapshotError, body_file, task_file, write_task

T = TypeVar("T")


@dataclass(frozen=True, kw_only=True)
class Goal:
    """Stopping criteria of the work on a set.

    Attributes:
        next_round: what a set that grows needs next for a relative error [-].
        error: relative error of the model that is good enough [-].
        seconds: after which no further line is begun.
    """

    next_round: Callable[[float], Round] | None = None
    error: float = 0.0
    seconds: float = math.inf


@dataclass
class Work:
    """Work that a group of ranks did: lines of states, the time solving them took, and the time in all [s].

    If it did not end because all is done, `stopped` says why.
    """

    lines: int = 0
    solve_seconds: float = 0.0
    seconds: float = 0.0
    stopped: str = ""


def run(
    description: Description,
    model: FingerModel,
    path: str | Path,
    progress: Callable[[], None],
    goal: Goal = Goal(),
    known: Known = NOTHING_KNOWN,
) -> Work:
    """Work on a set until none of its tasks is missing; every group of a job calls this, and none waits for another.

    Args:
        description: what the set holds, begun by `rom.dataset.create`.
        model: this group's model.
        path: the set's folder.
        progress: called on the group's first rank whenever it looks for a task.
        goal: when to stop, and how a set grows.
        known: states of other sets that save work.

    Raises:
        SnapshotError: the folder holds something else or cannot be written.
    """
    begun, work = time.perf_counter(), Work()
    solver, comm = LineSolver(description, model, path, known), model.problem.comm
    on_first(comm, lambda: body(model.scene, solver.numbering.nodes).write(body_file(path)))
    with Queue(description, path, solver.ready, progress, goal) if comm.rank == 0 else nullcontext() as queue:
        while (claimed := on_first(comm, lambda: queue.claim())) is not None:  # type: ignore[union-attr]
            task, deaths = claimed
            if deaths < ledger.DEATHS:
                arrays = solver.solve(task)
            else:
                arrays = solver.give_up(task, f"{ledger.QUARANTINED}: {deaths} processes died at it")
            on_first(comm, lambda arrays=arrays: queue.finish(arrays))  # type: ignore[union-attr, misc]
            work.lines += 1
            work.solve_seconds += float(arrays["seconds"])
        work.stopped = queue.stopped if queue is not None else ""
    work.seconds = time.perf_counter() - begun
    return work


def on_first(comm: MPI.Comm, call: Callable[[], T]) -> T:
    """Calls on the first rank; returns its result, or raises its error, on every rank."""
    answer, error = None, None
    if comm.rank == 0:
        try:
            answer = call()
        except Exception as caught:
            error = caught
    if comm.size > 1:
        answer, error = comm.bcast((answer, error))
    if error is not None:
        raise error
    return answer  # type: ignore[return-value]


class Queue:
    """The tasks of a set that are still to be solved, for one process at a time."""

    def __init__(
        self,
        description: Description,
        path: str | Path,
        ready: Callable[[str], bool],
        progress: Callable[[], None],
        goal: Goal = Goal(),
    ):
        self._description, self._path, self._ready, self._progress = description, Path(path), ready, progress
        self._plan, self._goal, self._begun = Plan(path, description), goal, time.monotonic()
        self.stopped = ""
        self._pending: list[str] = []
        self._index: dict[str, int] = {}
        self._task: str | None = None
        self._claims = open_claims(path)

    def claim(self) -> tuple[str, int] | None:
        """A task that nobody else works on, and how many processes died at it; None when none is missing."""
        while True:
            self._progress()
            if time.monotonic() - self._begun > self._goal.seconds:
                self.stopped = "the budget is spent; the same command goes on"
                return None
            if not self._pending:
                self._plan.refresh()
                self._index = {task: i for i, task in enumerate(self._plan.lines)}
                self._pending = self._plan.missing()
            if not self._pending:
                if self._complete():
                    return None
                continue
            for task in list(self._pending):
                if self._done(task):
                    self._pending.remove(task)
                elif self._ready(task) and self._claims.take(self._index[task]):
                    if not self._done(task):
                        self._task = task
                        deaths = ledger.deaths(self._path, task)
                        ledger.begin(self._path, task)
                        return task, deaths
                    self._claims.give_back(self._index[task])
            time.sleep(0.05)  # others hold what is left, or what it needs

    def _complete(self) -> bool:
        """True if there is nothing left to do; else one of all ranks plans the next round."""
        plan, next_round = self._plan, self._goal.next_round
        if next_round is None or plan.ended(self._goal.error):
            return True
        number, place = len(plan.rounds), len(plan.lines)
        if self._claims.take(place):
            try:
                plan.refresh()
                if len(plan.rounds) == number:
                    plan.add(next_round(self._goal.error))
            except SnapshotError as error:  # every rank comes here, finds the same, and ends
                self.stopped = f"no lines were added: {error}"
                return True
            finally:
                self._claims.give_back(place)
        else:
            time.sleep(0.05)
            plan.refresh()
        return False

    def finish(self, arrays: Arrays) -> None:
        """Write what the claimed task's states are, and free it."""
        assert self._task is not None
        write_task(self._path, self._task, self._description.fingerprint, arrays)
        ledger.end(self._path, self._task)
        self._claims.give_back(self._index[self._task])
        self._task = None

    def _done(self, task: str) -> bool:
        return task_file(self._path, task).exists()

    def __enter__(self) -> Self:
        self._claims.__enter__()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: object) -> None:
        # A task that was dropped because of its surroundings is not to blame.
        if self._task is not None and isinstance(error, (SystemExit, KeyboardInterrupt, OSError, ValueError)):
            ledger.withdraw(self._path, self._task)
        self._claims.__exit__(None, None, None)
