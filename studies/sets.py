"""The scenes and snapshot sets that the studies of the surrogate share; what is solved is not solved again."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from rom.snapshots.snapshot_set import SnapshotSet
from studies.training.training import farm

ROOT = Path(__file__).resolve().parents[1]
# Scene, its cells if not the scene's own, and its sampling.
SCENES = {
    "draft": ("draft", None, ""),
    "middle": ("draft", "[40, 7]", "lines = 60"),
    "middle few": ("draft", "[40, 7]", "lines = 60\ncontact_nodes = 4"),
    "reference": ("draft", "[80, 11]", ""),
    "paper": ("one_segment", None, "lines = 6\ncontact_nodes = 4"),
    "two segments": ("two_segments", None, "lines = 60"),
    "draft lines": ("draft", None, "lines = 40"),
}
FRESH, SCALING = (200, 11), (200, 12)  # held-out states and their seeds: to judge by, and to scale errors by
QUICK = "tension_nodes = 5\ncontact_nodes = 6"
QUICK_FRESH = (40, 11)


def scene(folder: Path, name: str, quick: bool = False) -> Path:
    """The file of a scene."""
    source, cells, sampling = SCENES[name]
    text = (ROOT / "scenes" / f"{source}.toml").read_text().split("[sampling]")[0]
    if cells is not None:
        text = text.replace("cells = [20, 5]", f"cells = {cells}")
    sampling = QUICK if quick else sampling
    return written(folder, name, text + (f"\n[sampling]\n{sampling}\n" if sampling else ""))


def written(folder: Path, name: str, text: str) -> Path:
    """A scene's file from its text."""
    file = folder / f"{name.replace(' ', '-')}.toml"
    file.write_text(text)
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


def held_out(file: Path, kind: str, count: int, seed: int) -> SnapshotSet:
    """Held-out states of a scene, in the folder beside its file."""
    place = file.with_suffix("") / kind
    farm(2, file, place, "--random", str(count), "--seed", str(seed))
    return SnapshotSet(place)
