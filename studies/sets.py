"""The scenes and snapshot sets that studies share; what is solved is not solved again."""

from __future__ import annotations

import json
import subprocess
import sys
import time
import tomllib
from pathlib import Path
from typing import Any

from rom.dataset.snapshot_set import SnapshotSet
from rom.files.atomic_file import write_whole

ROOT = Path(__file__).resolve().parents[1]
STANDARD, REFERENCE = (10, 5, 2), (32, 7, 2)  # cells along and across, Lagrange order
SEED = 11


def draft_table(mesh: tuple[int, int, int] | None = None) -> dict[str, Any]:
    """The draft finger before its plane, without sampling, perhaps on another mesh: cells along and across, order."""
    table = tomllib.loads((ROOT / "scenes" / "draft.toml").read_text())
    del table["sampling"]
    return table if mesh is None else table | {"mesh": {"cells": list(mesh[:2]), "order": mesh[2]}}


def draft(folder: Path) -> Path:
    """The file of the draft finger before its plane, of which held-out states are drawn."""
    return written(folder, "draft", as_toml(draft_table()))


def grid_scene(folder: Path, tension_nodes: int, contact_nodes: int) -> Path:
    """The draft finger on another grid."""
    table = draft_table() | {"sampling": {"tension_nodes": tension_nodes, "contact_nodes": contact_nodes}}
    return written(folder, f"draft {tension_nodes} {contact_nodes}", as_toml(table))


def written(folder: Path, name: str, text: str) -> Path:
    """A scene's file from its text; two processes may write it at once."""
    file = folder / f"{name.replace(' ', '-')}.toml"
    write_whole(file, lambda stream: stream.write(text.encode()))
    return file


def as_toml(table: dict[str, Any]) -> str:
    """A scene's table as text; keys without a value are left out."""
    plain = [
        f"{key} = {json.dumps(value)}" for key, value in table.items() if not _is_table(value) and value is not None
    ]
    for key, value in table.items():
        for one in value if isinstance(value, list) else [value]:
            if isinstance(one, dict):
                head = f"[[{key}]]" if isinstance(value, list) else f"[{key}]"
                inner = {k: v for k, v in one.items() if not isinstance(v, dict)}
                plain.append(f"\n{head}\n{as_toml(inner)}")
                plain += [f"[{key}.{k}]\n{as_toml(v)}" for k, v in one.items() if isinstance(v, dict)]
    return "\n".join(plain) + "\n"


def _is_table(value: Any) -> bool:
    return isinstance(value, dict) or (isinstance(value, list) and bool(value) and isinstance(value[0], dict))


def training(file: Path) -> SnapshotSet:
    """The training set of a scene, in the folder beside its file."""
    place = file.with_suffix("") / "training"
    farm(2, file, place)
    return SnapshotSet(place)


def held_out(file: Path, count: int) -> SnapshotSet:
    """Random states of a scene, in the folder beside its file; each begins at the nearest of the training set."""
    place = file.with_suffix("") / f"held-out-{count}"
    near = file.with_suffix("") / "training"
    options = ["--near", str(near)] if near.exists() else []
    farm(2, file, place, "--random", str(count), "--seed", str(SEED), *options)
    return SnapshotSet(place)


def farm(ranks: int, file: Path, folder: Path, *options: str) -> dict:
    """Run the farm on a set until it is complete; its report, and its wall time [s]."""
    command = [sys.executable, "-m", "fingerfem", "snapshots", str(file), str(folder), "--json", *options]
    begun = time.perf_counter()
    job = subprocess.run(["mpirun", "-n", str(ranks), *command], cwd=ROOT, stdout=subprocess.PIPE, text=True)
    if job.returncode:
        raise SystemExit(f"the farm ended with {job.returncode}")
    return json.loads(job.stdout.splitlines()[-1]) | {"wall_seconds": time.perf_counter() - begun}
