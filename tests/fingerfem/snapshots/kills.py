"""Writes a set and models in processes that are killed at their k-th change of a file, for k = 1, 2, ...

python3 kills.py SET/ FOLDER/, with hostile.so preloaded. Prints the number of kills by what was written, as JSON.
"""

import ctypes
import json
import os
import shutil
import signal
import sys
from collections.abc import Callable
from functools import partial
from itertools import count
from pathlib import Path

import numpy as np

from control.export.page import write as write_page
from fingerfem.snapshots import ledger
from rom import Rod, TouchedSegment
from rom.dataset.folder import create
from rom.dataset.plan import Plan, Round, read_round
from rom.dataset.snapshot_set import (
    SnapshotError,
    SnapshotSet,
    body_file,
    read_description,
    read_task,
    task_file,
    write_task,
)
from rom.export.c_header import export
from rom.rod.touched_segment import SHIPPED

MACHINE = ctypes.CDLL(None)


def killed_at(k: int, work: Callable[[], None]) -> bool:
    """True if a process that does some work was killed at its k-th change of a file; else it has done it."""
    child = os.fork()
    if child == 0:
        MACHINE.hostile_kill(ctypes.c_long(k))
        work()
        os._exit(0)
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    assert code in (0, -signal.SIGKILL), code
    return code != 0


class SmallSet:
    """Two lines of another set, solved again as the farm does it, and a round."""

    def __init__(self, source: Path):
        self.source = SnapshotSet(source)
        self.description = self.source.description
        self.tasks = list(self.description.lines)[:2]

    def write(self, folder: Path) -> None:
        create(folder, self.description)
        self.source.body.write(body_file(folder))
        for task in self.tasks:
            if task_file(folder, task).exists():
                continue
            ledger.begin(folder, task)
            write_task(folder, task, self.description.fingerprint, read_task(self.source.path, task))
            ledger.end(folder, task)
        plan = Plan(folder, self.description)
        if not plan.rounds:
            plan.add(Round(error=0.5, threshold=0.1, lines={}))

    def assert_honest(self, folder: Path) -> None:
        """Whatever there is, is whole, and it does not pass as a finished set."""
        try:
            assert read_description(folder) == self.description
        except SnapshotError:
            assert not (folder / "set.json").exists()
            return
        for file in folder.glob("tasks/[!.]*"):
            stored, true = read_task(folder, file.stem), read_task(self.source.path, file.stem)
            assert all(
                np.array_equal(stored[name], true[name], equal_nan=stored[name].dtype.kind == "f") for name in true
            )
        if body_file(folder).exists():
            assert np.array_equal(self.source.body.read(body_file(folder)).nodes, self.source.nodes)
        assert all(read_round(file).error == 0.5 for file in folder.glob("rounds/[!.]*"))
        assert all(ledger.deaths(folder, task) <= 1 for task in self.tasks)
        try:
            SnapshotSet(folder)
        except SnapshotError as error:
            assert "tasks are not solved yet" in str(error)
        else:
            raise AssertionError("it passes as finished")


def kill_a_set(source: Path, folder: Path) -> int:
    """Kill at every change of a set's files; the next run goes on where the killed one was."""
    small = SmallSet(source)
    for k in count(1):
        if not killed_at(k, lambda: small.write(folder)):
            return k - 1
        small.assert_honest(folder)
        small.write(folder)
        small.assert_honest(folder)
        assert all(task_file(folder, task).exists() for task in small.tasks) and list(folder.glob("rounds/0000.json"))
        shutil.rmtree(folder)
    raise AssertionError


def kill_a_file(file: Path, write: Callable[[Path], object], assert_whole: Callable[[Path], object]) -> int:
    """Kill at every change of a file, which is new or there before: it is then absent, the old one or a new one."""
    kills = 0
    for old in (None, b"old"):
        for k in count(1):
            file.unlink(missing_ok=True)
            if old is not None:
                file.write_bytes(old)
            done = not killed_at(k, lambda: write(file))
            if done or (file.exists() and file.read_bytes() != old):
                assert_whole(file)
            else:
                assert file.exists() == (old is not None)
            if done:
                break
            kills += 1
    return kills


def text_of(write: Callable[[Path], object], file: Path) -> Callable[[Path], None]:
    """A check that a file has the text that is written where nothing happens."""
    write(file)
    whole = file.read_bytes()

    def check(found: Path) -> None:
        assert found.read_bytes() == whole

    return check


def main(source: Path, folder: Path) -> None:
    """Kill everything."""
    model, finger = TouchedSegment.load(), Rod.load(SHIPPED)
    header, page = folder / "finger.h", folder / "finger.html"
    found = {
        "set": kill_a_set(source, folder / "set"),
        "rod": kill_a_file(folder / "finger.h5", finger.save, Rod.load),
    }
    for name, file, write in (("header", header, export), ("page", page, write_page)):
        one = partial(write, model)
        found[name] = kill_a_file(file, one, text_of(one, file))
    print(json.dumps(found))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
