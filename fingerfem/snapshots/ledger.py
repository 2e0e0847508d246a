"""Outcomes of every state of a set: solved, failed and why, given up after the third death, or still to do.

Solved and failed states stand in the tasks' files. Attempts that have not ended stand in `attempts/TASK`, one line
each: a process that dies leaves its line behind. One that was asked to end by a signal is no death, even if it was
killed before it could take its line back: the number of the signal, a byte, follows the line.
"""

from __future__ import annotations

import contextlib
import os
import signal
import socket
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from rom.dataset.plan import Plan
from rom.dataset.snapshot_set import Description, SnapshotError, read_task, task_file

DEATHS = 3  # of processes at one task, after which nobody tries it again
# Signs after the note of a process that was asked to end. mpirun and scancel send SIGCONT before SIGTERM, which METIS
# catches for itself while CHOLMOD orders unknowns: its handler leaves Python's none to see.
ASKED = tuple(map(chr, (signal.SIGINT, signal.SIGTERM, signal.SIGCONT)))
QUARANTINED = "quarantined"  # start of the reason of such states


def deaths(path: str | Path, task: str) -> int:
    """Number of processes that died at a task nobody works on now."""
    try:
        notes = _attempts(path, task).read_text().split("\n")
    except OSError:
        return 0
    return sum(after[:1] not in ASKED for after in notes[1:])


def begin(path: str | Path, task: str) -> None:
    """Note an attempt at a task; the note stays if the process dies.

    A signal that Python handles adds its number to the note, at once: where Python waits for compiled code, its handler
    may be too late, as mpirun kills a quarter of a second after it asks to end.
    """
    file = _attempts(path, task)
    file.parent.mkdir(exist_ok=True)
    note = os.open(file, os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_NONBLOCK, 0o644)
    os.write(note, _me().encode())
    _close(signal.set_wakeup_fd(note, warn_on_full_buffer=False))


def _me() -> str:
    return f"{socket.gethostname()} {os.getpid()}\n"


def _close(note: int) -> None:
    if note >= 0:
        os.close(note)


def withdraw(path: str | Path, task: str) -> None:
    """Take this process's note back, if it is there yet: the attempt was dropped."""
    _close(signal.set_wakeup_fd(-1))
    file = _attempts(path, task)
    try:
        former, mine, _ = file.read_text().rpartition(_me())
    except FileNotFoundError:
        return
    if mine and former:
        file.write_text(former)
    elif mine:
        file.unlink()


def end(path: str | Path, task: str) -> None:
    """Forget a task's attempts: it has its file."""
    _close(signal.set_wakeup_fd(-1))
    _attempts(path, task).unlink(missing_ok=True)


def _attempts(path: str | Path, task: str) -> Path:
    return Path(path) / "attempts" / task


def sentence(description: Description, task: str, parameters: np.ndarray, last_good: np.ndarray, reason: str) -> str:
    """One line about a state that has no answer: parameters and last good load, shapes (p,) [N, m], nan without."""

    def loads(values: np.ndarray) -> str:
        named = zip(description.parameters, values, strict=True)
        return " ".join(f"{one['name']}={value:.6g}" for one, value in named if np.isfinite(value))

    where = f"{task} {loads(parameters)}: {reason}"
    return where + (f"; last good load {loads(last_good)}" if np.isfinite(last_good).any() else "")


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """Outcome of a task.

    Attributes:
        states: how many it has.
        failures: parameters, last good load and reason of every state that has no answer.
        iterations: Newton's, in all.
        seconds: that solving took.
        size: of its file [bytes].
    """

    states: int
    failures: list[tuple[np.ndarray, np.ndarray, str]]
    iterations: int
    seconds: float
    size: int

    @classmethod
    def read(cls, path: str | Path, task: str) -> Outcome:
        """Reads a task's file without its fields.

        Raises:
            SnapshotError: the file is no task's.
        """
        names = ("parameters", "last_good", "reason", "converged", "iterations", "seconds")
        stored = read_task(path, task, names)
        return cls(
            states=len(stored["converged"]),
            failures=[
                (stored["parameters"][k], stored["last_good"][k], str(stored["reason"][k]))
                for k in np.flatnonzero(~stored["converged"])
            ],
            iterations=int(stored["iterations"].sum()),
            seconds=float(stored["seconds"]),
            size=task_file(path, task).stat().st_size,
        )


@dataclass
class Ledger:
    """The outcomes of a set, read once each as they appear."""

    path: Path
    description: Description
    outcomes: dict[str, Outcome] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.plan = Plan(self.path, self.description)

    def refresh(self) -> None:
        """Read what is new, forget what is gone."""
        self.plan.refresh()
        present = {file.stem for file in (self.path / "tasks").glob("*.npz")}
        self.outcomes = {task: outcome for task, outcome in self.outcomes.items() if task in present}
        for task in self.plan.lines:
            if task in present and task not in self.outcomes:
                with contextlib.suppress(SnapshotError):  # whatever is not whole is missing
                    self.outcomes[task] = Outcome.read(self.path, task)

    @property
    def missing(self) -> list[str]:
        """Tasks that are still to be solved."""
        return [task for task in self.plan.lines if task not in self.outcomes]

    @property
    def states(self) -> int:
        """States that are solved or failed."""
        return sum(outcome.states for outcome in self.outcomes.values())

    @property
    def failures(self) -> list[tuple[str, np.ndarray, np.ndarray, str]]:
        """Task, parameters and last good load, shapes (p,) [N, m], and reason of every state that has no answer."""
        return [(task, *failure) for task, outcome in self.outcomes.items() for failure in outcome.failures]

    def forget_failures(self) -> list[str]:
        """Remove the files of tasks with failures; returns the tasks."""
        failed = [task for task, outcome in self.outcomes.items() if outcome.failures]
        for task in failed:
            task_file(self.path, task).unlink(missing_ok=True)
            end(self.path, task)
            del self.outcomes[task]
        if failed:
            self.plan.reopen()
        return failed

    def summary(self) -> dict[str, Any]:
        """Numbers of a set's solved, failed and remaining states, with cost and size."""
        failures, size = self.failures, sum(outcome.size for outcome in self.outcomes.values())
        quarantined = sum(reason.startswith(QUARANTINED) for *_, reason in failures)
        rounds = self.plan.rounds
        refined = (
            {"rounds": len(rounds), "estimated_error": rounds[-1].error} if self.description.refines and rounds else {}
        )
        return refined | {
            "tasks": len(self.plan.lines),
            "missing": len(self.missing),
            "states": self.states,
            "solved": self.states - len(failures),
            "failed": len(failures) - quarantined,
            "quarantined": quarantined,
            "newton_iterations": sum(outcome.iterations for outcome in self.outcomes.values()),
            "solve_seconds": sum(outcome.seconds for outcome in self.outcomes.values()),
            "bytes_per_state": round(size / self.states) if self.states else 0,
            # Begun and not ended: somebody works on it, or died at it; the third death is the last.
            "begun": {task: count for task in self.missing if (count := deaths(self.path, task))},
        }
