"""Files of models: HDF5 behind a line of text that says what it is, its format, and the checksum of all that follows.

The line stands in the block that HDF5 leaves to its users. Nothing is read before its checksum agrees: the HDF5 library
itself can crash on a damaged file.
"""

import hashlib
import io
import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import h5py
import numpy as np

from rom.files.atomic_file import write_whole
from rom.files.file_kinds import uses_of

T = TypeVar("T")
BLOCK = 512  # bytes before what is HDF5
SHOWN = 200  # characters of a value in a message
COMPRESSED = 1024  # bytes from which on an array is


class ModelError(ValueError):
    """A model file that cannot be read, or inputs of the wrong shape: one line."""


def save(path: Path, kind: str, number: int, write: Callable[[h5py.File], None]) -> None:
    """Write a file of a kind and format: it is whole or absent.

    HDF5 works in memory, as its library can crash where a disk is full.

    Raises:
        OSError: it cannot be written.
    """
    memory = io.BytesIO()
    with h5py.File(memory, "w", userblock_size=BLOCK, libver="v110") as stored:
        write(stored)
    contents = bytearray(memory.getvalue())
    line = f"{kind}, format {number}, sha256 {hashlib.sha256(contents[BLOCK:]).hexdigest()}\n".encode()
    contents[: len(line)] = line
    write_whole(path, lambda stream: stream.write(contents))


def load(path: Path, kind: str, number: int, read: Callable[[h5py.File], T]) -> T:
    """Reads a file of a kind and format by `read`.

    Raises:
        ModelError: no file, none of this kind, a damaged one, or one of another format.
    """
    try:
        _check(path, kind, number)
        with h5py.File(path, "r") as stored:
            return read(stored)
    except ModelError as error:
        if str(path) in str(error):
            raise
        raise ModelError(f"{path}: {error}") from None
    except FileNotFoundError:
        raise ModelError(f"{path}: No such file") from None
    except Exception as error:  # whatever wrote a file whose checksum is right, it was not this project
        if path.is_dir():
            raise ModelError(f"{path}: is not a model file, but a folder{uses_of(path)}") from None
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        raise ModelError(f"{path}: is not a model file ({reason})") from None


def require(ok: bool, rule: str, value: object) -> None:
    """Refuse a file whose contents do not keep a rule.

    Raises:
        ModelError: they do not; one line with the rule and the value.
    """
    if not ok:
        text = str(value)
        raise ModelError(f"{rule}, got {text if len(text) <= SHOWN else text[:SHOWN] + '...'}")


def kind_of(path: Path) -> str:
    """The kind that a file says it is of; empty if it says nothing."""
    try:
        with path.open("rb") as stream:
            return stream.read(BLOCK).split(b",")[0].decode(errors="replace")
    except OSError:
        return ""


def _check(path: Path, kind: str, number: int) -> None:
    contents = path.read_bytes()
    if not contents:
        raise ModelError(f"{path}: is not a model file, but empty")
    words = contents[:BLOCK].split(b"\n")[0].decode(errors="replace").split(", ")
    if len(words) != 3 or not words[0].startswith("fingerfem "):
        raise ModelError(f"{path}: is not a model file{uses_of(path)}")
    if words[0] != kind:
        raise ModelError(f"{path}: must be a {kind}, got a {words[0]}{uses_of(path)}")
    if words[1] != f"format {number}":
        raise ModelError(f"{path}: must be a model of format {number}, got {words[1]}; build it again")
    if words[2] != f"sha256 {hashlib.sha256(contents[BLOCK:]).hexdigest()}":
        raise ModelError(f"{path}: is damaged: its checksum is not that of its contents; copy or build it again")


def dataset(group: h5py.Group, name: str, values: np.ndarray, unit: str) -> None:
    """Stored in the smallest type that holds every value exactly, compressed if that is worth it."""
    if values.dtype.kind in "iu":
        values = values.astype(np.min_scalar_type(values.max(initial=0)))
    else:
        with np.errstate(over="ignore"):  # what is too large for single precision differs from it
            single = values.astype(np.float32)
        values = single if np.array_equal(single, values) else values
    worth = {"compression": "gzip", "shuffle": True} if values.nbytes >= COMPRESSED else {}
    group.create_dataset(name, data=values, **worth)
    group[name].attrs["unit"] = unit


def shaped(name: str, values: np.ndarray, shape: tuple[int, ...], finite: bool = True) -> None:
    """Refuse an array of another shape, or with numbers that are not finite.

    Raises:
        ModelError: one line that names it and its rule.
    """
    require(values.shape == shape, f"{name} must have shape {shape}", values.shape)
    require(not finite or bool(np.isfinite(values).all()), f"{name} must be finite", "others")


def write_tree(group: h5py.Group, tree: Mapping[str, Any]) -> None:
    """Write what a group holds: arrays with their units, groups as tables, and plain data as JSON attributes."""
    for name, item in tree.items():
        if isinstance(item, tuple):
            dataset(group, name, *item)
        elif isinstance(item, Mapping) and any(isinstance(part, tuple) for part in item.values()):
            write_tree(group.create_group(name), item)
        else:
            group.attrs[name] = json.dumps(item)


def read_tree(group: h5py.Group) -> dict[str, Any]:
    """The same without the units; numbers that are no integers in double precision."""
    tree = {name: json.loads(text) for name, text in group.attrs.items()}
    for name, item in group.items():
        if isinstance(item, h5py.Group):
            tree[name] = read_tree(item)
        else:
            tree[name] = item[()] if item.dtype.kind in "iu" else item[()].astype(float)
    return tree
