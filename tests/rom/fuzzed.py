"""Model files that are wrong in one way or in several, with a right checksum; and what is asked of those that are read.

As a program it reads the files of a folder and asks everything of them: `python3 -m tests.rom.fuzzed FOLDER`. It prints
how many were refused and how many answered, and all other exceptions. A test runs it under AddressSanitizer.
"""

import hashlib
import json
import sys
import traceback
import warnings
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from control import Finger, problems
from rom import Hull, SeparatedModel, Sphere, TouchedSegment, load
from rom.export.c_header import header
from rom.export.model import struct
from rom.files.checked_file import BLOCK, ModelError
from rom.native import LIBRARY, pointer
from rom.rod.compiled.contacts import find_contacts, material_points
from rom.rod.compiled.evaluation import sections
from rom.rod.compiled.reports import Reports
from tests.rom.rod.inverse import inverse, spring

NUMBERS = (np.nan, np.inf, -np.inf, 0.0, -1.0, 1e300, 1e-300, 255, 65535, 2**31, -(2**31))
POINTS = 10
WRENCHES = 3072  # numbers of loads, at most
SMALL = 50  # points of an atlas: its size matters to no access


def with_checksum(contents: bytes, line: bytes) -> bytes:
    """A file of a kind and format whose checksum is that of its contents."""
    words = line.split(b", ")
    digest = hashlib.sha256(contents[BLOCK:]).hexdigest().encode()
    return b", ".join([*words[:2], b"sha256 " + digest + b"\n"]).ljust(BLOCK, b"\0") + contents[BLOCK:]


def write(source: Path, target: Path, random: np.random.Generator) -> str:
    """Write a file that is wrong; what was changed."""
    contents = source.read_bytes()
    line = contents[:BLOCK].split(b"\n")[0]
    if random.random() < 0.05:  # cut off
        cut = contents[: int(random.integers(len(contents)))]
        target.write_bytes(with_checksum(cut, line) if random.random() < 0.5 and len(cut) > BLOCK else cut)
        return "cut"
    target.write_bytes(contents)
    made = []
    with h5py.File(target, "r+") as file, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # numbers that do not fit are what is wanted
        for _ in range(random.integers(1, 4)):
            change = CHANGES[random.integers(len(CHANGES))]
            made.append(change.__name__)
            change(file, random)
    changed = target.read_bytes()
    if random.random() < 0.03:  # of another kind
        kinds = (b"fingerfem rod", b"fingerfem separated model", b"fingerfem segment map", b"fingerfem")
        line = line.replace(line.split(b",")[0], kinds[random.integers(len(kinds))])
        made.append("kind")
    target.write_bytes(with_checksum(changed, line))
    return ", ".join(made)


def datasets(file: h5py.File) -> list[str]:
    found: list[str] = []
    file.visititems(lambda name, one: found.append(name) if isinstance(one, h5py.Dataset) else None)
    return found


def attributes(file: h5py.File) -> list[tuple[h5py.Group, str]]:
    found = [(file, name) for name in file.attrs]
    file.visititems(lambda _, one: found.extend((one, name) for name in one.attrs if name not in ("unit", "axis")))
    return found


def replace(file: h5py.File, random: np.random.Generator, change: Callable[[np.ndarray], Any]) -> None:
    """Change the numbers of one dataset."""
    names = datasets(file)
    if not names:
        return
    name = names[random.integers(len(names))]
    values = file[name][()]
    del file[name]
    try:
        file[name] = change(values)
    except (TypeError, ValueError, OverflowError):  # what HDF5 or a kind does not hold
        file[name] = values


def size(file: h5py.File, random: np.random.Generator) -> None:
    def changed(values: np.ndarray) -> np.ndarray:
        if not np.ndim(values):
            return values
        axis = int(random.integers(values.ndim))
        count = values.shape[axis]
        wanted = (0, 1, max(count - 1, 0), count + 1, 2 * count, count // 2)[random.integers(6)]
        return np.take(values, np.arange(wanted) % max(count, 1), axis=axis) if count else values

    replace(file, random, changed)


def axes(file: h5py.File, random: np.random.Generator) -> None:
    def changed(values: np.ndarray) -> np.ndarray:
        return values.T if random.random() < 0.6 else values.ravel() if random.random() < 0.5 else values[None]

    replace(file, random, changed)


def numbers(file: h5py.File, random: np.random.Generator) -> None:
    def changed(values: np.ndarray) -> np.ndarray:
        found = values.astype(float) if random.random() < 0.3 else values.copy()
        if found.size and found.dtype.kind in "fiu":
            with np.errstate(all="ignore"):
                wrong = np.array(NUMBERS[random.integers(len(NUMBERS))]).astype(found.dtype)
            found.ravel()[random.integers(found.size, size=random.integers(1, 4))] = wrong
        return found

    replace(file, random, changed)


def dtype(file: h5py.File, random: np.random.Generator) -> None:
    kinds = ("S8", "f2", "i1", "u1", "i8", "c16", "f8")

    def changed(values: np.ndarray) -> np.ndarray:
        with np.errstate(all="ignore"):
            return values.astype(kinds[random.integers(len(kinds))])

    replace(file, random, changed)


def scale(file: h5py.File, random: np.random.Generator) -> None:
    replace(file, random, lambda values: values * (-1.0) ** random.integers(2) * 10.0 ** random.integers(-30, 30))


def another(file: h5py.File, random: np.random.Generator) -> None:
    others = [file[name][()] for name in datasets(file)]
    replace(file, random, lambda _: others[random.integers(len(others))])


def without(file: h5py.File, random: np.random.Generator) -> None:
    found: list[str] = []
    file.visit(found.append)
    owned = attributes(file)
    if random.random() < 0.5 and found:
        del file[found[random.integers(len(found))]]
    elif owned:
        group, name = owned[random.integers(len(owned))]
        del group.attrs[name]


def attribute(file: h5py.File, random: np.random.Generator) -> None:
    owned = attributes(file)
    if not owned:
        return
    group, name = owned[random.integers(len(owned))]
    value = group.attrs[name]
    if not isinstance(value, str) or not value.startswith(("[", "{")):
        group.attrs[name] = (*NUMBERS, "text", np.arange(3))[random.integers(len(NUMBERS) + 2)]
        return
    plain = json.loads(value)
    wrong_somewhere(plain, random)
    group.attrs[name] = json.dumps(plain)


def wrong_somewhere(plain: Any, random: np.random.Generator) -> None:
    """Change plain data at one place, as deep as it goes."""
    keys: list[Any] = list(plain) if isinstance(plain, dict) else list(range(len(plain)))
    if not keys:
        return
    key = keys[random.integers(len(keys))]
    if isinstance(plain[key], (dict, list)) and plain[key] and random.random() < 0.8:
        wrong_somewhere(plain[key], random)
    elif random.random() < 0.3:
        del plain[key]
    elif isinstance(plain, list) and random.random() < 0.3:
        plain.extend(plain * int(random.integers(1, 5)))
    else:
        plain[key] = (*NUMBERS, None, "text", [], {})[random.integers(len(NUMBERS) + 4)]


CHANGES = (size, axes, numbers, numbers, dtype, scale, another, without, attribute, attribute)


def asked(model: SeparatedModel | TouchedSegment, random: np.random.Generator) -> None:
    """Everything that compiled code computes of a model, inside and outside."""
    lower, upper = model.limits
    points = lower + (1.4 * random.random((POINTS, len(lower))) - 0.2) * (upper - lower)
    points[0], points[1, 0], points[2, -1], points[3] = upper, np.nan, np.inf, lower
    model.evaluate(points)
    for point in points[:6]:
        model.evaluate(point)
        model.value_and_jacobian(point)
    own = struct(model)
    memory = np.empty(LIBRARY.functions.fingerfem_model_memory(own))
    corners = np.empty((max(own.sections, 1), 4, 3))
    for point in points[:6]:
        out, errors, jacobian, wrench = np.empty(6), np.empty(4), np.empty((6, len(point))), np.zeros(WRENCHES)
        report = Reports.empty(1, len(point) - 1, 1)
        given = map(pointer, (point.copy(), memory, wrench, out, errors, jacobian))
        LIBRARY.functions.fingerfem_model_evaluate(own, *given, report.struct)
        LIBRARY.functions.fingerfem_model_sections(own, *map(pointer, (point.copy(), wrench, memory, corners)))
    if isinstance(model, TouchedSegment):
        asked_of_a_rod(model, points)
    else:
        header(model)
        if model.nodes is not None:
            model.displacement(points[3])
    asked_of_a_finger(model, points)


def asked_of_a_rod(model: TouchedSegment, points: np.ndarray) -> None:
    model.answers(points, by_object=True)
    model.contact_forces(points[3])
    first = model.rod.segments[0]
    sections(model.rod.struct, points[4, :-1], np.zeros((len(model.rod.segments), 6)))
    inputs = np.append(points[4, :-1], np.zeros(6))
    centre, *_ = first.place(inputs)
    loads = model.answers(points[4]).loads[0]
    found = find_contacts(model.touching, points[4, :-1], float(points[4, -1]), np.zeros(3), loads)
    if found is not None:
        material_points(model.rod.struct, points[3, :-1], loads, found)
    model.displacement(points[4])
    model.shortening(points[4])
    straight = [1.0, 0.0, 0.0, 0.0]
    spring(first.struct, straight, inverse(first.struct, points[4, :-1], centre + 1e-4, straight))
    where: dict[str, Any] = {"centre": tuple(np.nan_to_num(centre) + 0.01), "direction": (0.3, 1.0, 0.2)}
    corners = 0.004 * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    for one in (Sphere(radius=0.005, **where), Hull(vertices=[tuple(row) for row in corners], **where)):
        TouchedSegment(rod=model.rod, obstacle=one).evaluate(points[:4])


def asked_of_a_finger(model: SeparatedModel | TouchedSegment, points: np.ndarray) -> None:
    finger = Finger(model)
    tensions = points[4, : len(finger.lower)]
    goal = finger.rest + np.array([-0.001, 0.005, 0.0])
    finger.reach(goal)
    if not model.has_obstacle:
        return
    d = float(np.mean([end[-1] for end in model.limits]))
    finger.reach(goal, d)
    finger.hold(1.0, d)
    finger.locate(np.clip(tensions, finger.lower, finger.upper), 0.5)
    problems.grip(finger.compiled, finger.upper, 0.5, finger.lower, 1.0, d, 0.5, problems.rules(1e-6))


def main(folder: Path) -> None:
    problems.ATLAS = SMALL
    np.seterr(all="ignore")
    found, wrong = Counter[str](), []
    for k, file in enumerate(sorted(folder.glob("*.h5"))):
        (folder / "last").write_text(file.name)  # what a crash was at
        try:
            asked(load(file), np.random.default_rng(k))
            found["answered"] += 1
        except ModelError as error:
            assert "\n" not in str(error)
            found["refused"] += 1
        except Exception:
            wrong.append(f"{file.name}: {traceback.format_exc()}")
    print(json.dumps({**found, "wrong": wrong}))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
