"""The kinds of file that the project writes, and the commands that take each; refusals end with these."""

import json
from dataclasses import dataclass
from pathlib import Path

FIRST = 512  # bytes of a file by which its kind is recognised
_CONTROL = (
    "control reach",
    "control hold",
    "control grasp",
    "control campaign",
    "control export .html",
    "control export .fmu",
)
_SET = ("fingerfem snapshots", "fingerfem status", "fingerfem retry")


@dataclass(frozen=True)
class Kind:
    """A kind of file.

    Attributes:
        name: with its article.
        uses: the commands that take it, with the ending of what they write if only that one is possible.
    """

    name: str
    uses: tuple[str, ...]


SEPARATED = Kind(
    "a separated model",
    ("rom info", "rom check", "rom export .h", "rom export .fmu", *_CONTROL, "fingerfem certify"),
)
ROD = Kind(
    "a finger of rod elements",
    (
        *(
            "rom info",
            "rom assemble",
            "rom specialise",
            "rom check",
            "rom export .h",
            "rom export .fmu",
        ),
        *(*_CONTROL, "control calibrate", "fingerfem certify"),
    ),
)
AGAIN = "no command: solve its scene again by fingerfem snapshots SCENE.toml SET/, then rom build SET/ -o FINGER.h5"
OLD = Kind("a segment map of an earlier version", (AGAIN,))
SURROGATE = Kind(
    "a surrogate of an earlier version",
    ("no command: its successor is a table, by rom specialise FINGER.h5 -o TABLE.h5 or rom build SET/",),
)
TRAINING_SET = Kind("a training set", ("rom build", "rom check", *_SET))
HELD_OUT_SET = Kind("a held-out set", ("rom check", "rom build --held-out", *_SET))
SCENE = Kind(
    "a scene",
    (
        "fingerfem solve",
        "fingerfem simulate",
        "fingerfem modes",
        "fingerfem snapshots",
        "fingerfem render",
        "fingerfem sketch",
        "rom assemble",
    ),
)
FMU = Kind("an FMU", ("a simulation tool that imports FMI 2 or 3",))
HEADER = Kind("a C header", ("a C compiler",))
PAGE = Kind("a page", ("a browser",))
# Model files by what they begin with, others by their ending and a part of their text.
MODELS = {
    "fingerfem separated model": SEPARATED,
    "fingerfem surrogate": SURROGATE,
    "fingerfem rod": ROD,
    "fingerfem segment map": OLD,
    "fingerfem chain": OLD,
}
OTHERS = {".toml": (b"", SCENE), ".fmu": (b"PK", FMU), ".h": (b"", HEADER), ".html": (b"<", PAGE), ".htm": (b"<", PAGE)}


def kind_of(path: str | Path) -> Kind | None:
    """The kind of a file or folder; None for a file of another program, or one that cannot be read."""
    path = Path(path)
    try:
        if path.is_dir():
            return HELD_OUT_SET if json.loads((path / "set.json").read_text())["random"] else TRAINING_SET
        with path.open("rb") as stream:
            first = stream.read(FIRST)
    except (OSError, ValueError, TypeError, KeyError):
        return None
    text, other = OTHERS.get(path.suffix.lower(), (b"", None))
    return MODELS.get(first.split(b",")[0].decode(errors="replace")) or (other if first.startswith(text) else None)


def uses_of(path: str | Path) -> str:
    """The end of a refusal: the kind of a file and the commands that take it; empty for a file of another program."""
    kind = kind_of(path)
    return "" if kind is None else f"; it is {kind.name}, for {', '.join(kind.uses)}"
