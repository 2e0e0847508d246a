"""The folder of a snapshot set: begun once, by one of many, and kept free of files that are not its own."""

import contextlib
import json
import os
from dataclasses import asdict
from pathlib import Path

from rom.dataset.description import Description, difference
from rom.dataset.plan import Plan, PlanError, read_round
from rom.dataset.schema import FIELDS
from rom.dataset.snapshot_set import SnapshotError, read_description, read_task
from rom.files.atomic_file import write_whole

OURS = (
    "tasks",
    "rounds",
    "claim",
    "attempts",
    "set-aside",
    "progress.log",
    ".set.json.",
)  # may be there before set.json


def create(path: str | Path, description: Description) -> None:
    """Begin a set, or find that it was begun with the same description.

    Raises:
        SnapshotError: the folder holds something else.
    """
    path = Path(path)
    file = path / "set.json"
    try:
        path.mkdir(parents=True, exist_ok=True)
        strangers = [there for there in path.iterdir() if not there.name.startswith(OURS)]
        if strangers and not file.exists():  # in this order: another rank may begin the set meanwhile
            raise SnapshotError(f"{path}: must be a snapshot set or an empty folder")
        (path / "tasks").mkdir(exist_ok=True)
        if not file.exists():
            text = json.dumps(asdict(description), indent=1)
            write_whole(file, lambda stream: stream.write(text.encode()), once=True)
    except OSError as error:
        raise SnapshotError(f"{path}: must be a folder that can be written to, got {error.strerror}") from None
    present = read_description(path)  # of several jobs that begin a set at once, one has begun it
    for name in (
        "fingerprint",
        "tension_nodes",
        "contact_nodes",
        "random",
        "scattered",
        "begins_with",
        "versions",
        "stored",
    ):
        if getattr(present, name) != getattr(description, name):
            named = {
                "fingerprint": "another scene",
                "random": "other held-out points",
                "scattered": "other tensions",
                "stored": "other quantities",
                "begins_with": "other first lines",
            }
            if name == "fingerprint":
                other = difference(present.scene, description.scene)
                named[name] += f" ({other})" if other else ""
            what = named.get(name, f"other {name.replace('_', ' ')}")
            raise SnapshotError(f"{path}: holds a set of {what}; choose a new folder")


def set_aside_strangers(path: str | Path, description: Description) -> list[Path]:
    """Move task files that are not whole, or another set's, to `set-aside`; returns where they were.

    A failing disk leaves such, or somebody's editor.
    """
    strangers, files = [], sorted((Path(path) / "tasks").glob("*.npz"))
    tasks = Plan(path, description).lines  # after the files: a round is there before its tasks are
    for file in files:
        if file.stem not in tasks or _is_strange(file, description):
            strangers.append(file)
            _put_aside(path, file)
    return strangers


def _put_aside(path: str | Path, file: Path) -> None:
    aside = Path(path) / "set-aside"
    aside.mkdir(exist_ok=True)
    os.replace(file, aside / file.name)


def set_aside_broken_rounds(path: str | Path, description: Description) -> list[Path]:
    """Move the first round that is not whole, and all that followed from it, to `set-aside`; they are planned again."""
    files = sorted((Path(path) / "rounds").glob("*.json"))
    for number, file in enumerate(files):
        try:
            whole = all(description.has(line) for line in read_round(file).lines.values())
        except FileNotFoundError:  # another rank was faster
            return []
        except PlanError:
            whole = False
        if not whole:
            for later in files[number:]:
                with contextlib.suppress(FileNotFoundError):  # another rank was faster
                    _put_aside(path, later)
            return files[number:]
    return []


def _is_strange(file: Path, description: Description) -> bool:
    try:
        stored = read_task(file.parent.parent, file.stem, without=FIELDS)
    except SnapshotError:
        return True
    return str(stored["fingerprint"]) != description.fingerprint
