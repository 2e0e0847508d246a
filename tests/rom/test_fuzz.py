"""Files that are wrong are refused by name and limit, or answered without a wrong access to memory."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from assembled import in_series

from rom import Rod, SeparatedModel
from rom.files.checked_file import ModelError
from rom.native import LIBRARY, compiler
from rom.rod import limits as rod_limits
from rom.rod.scene.scene_of_rod import MOST_SEGMENTS
from rom.rod.touched_segment import SHIPPED
from rom.separated.model_file import MOST_PARAMETERS
from tests.rom import fuzzed

ROOT = Path(__file__).resolve().parents[2]
SANITIZED = "-g -fsanitize=address,undefined -fno-sanitize-recover=undefined"


def sanitizers() -> list[str]:
    """Paths of the compiler's run-time libraries; none if it has none."""
    files = [
        subprocess.run([*compiler().split(), f"-print-file-name={name}"], capture_output=True, text=True).stdout.strip()
        for name in ("libasan.so", "libubsan.so")
    ]
    return files if all(Path(file).is_absolute() for file in files) else []


@pytest.fixture(scope="module")
def rods(tmp_path_factory, finger) -> list[Path]:
    """Fingers of one segment and of two, and one of other elements."""
    folder = tmp_path_factory.mktemp("rods")
    in_series(Rod.load(SHIPPED), 2).save(folder / "two.h5")
    finger.save(folder / "elastic.h5")
    return [SHIPPED, folder / "two.h5", folder / "elastic.h5"]


@pytest.fixture(scope="module")
def tables(table_file, grid_file) -> list[Path]:
    """One without a field and one with it, and with a pad."""
    return [table_file, grid_file]


@pytest.fixture(params=["rods", "tables"])
def sources(request) -> list[Path]:
    return request.getfixturevalue(request.param)


def counted(sources: list[Path], folder: Path, cache: Path, files: int, seed: int) -> dict:
    """Counts of outcomes of so many wrong files, under sanitizers."""
    random, made = np.random.default_rng(seed), {}
    for k in range(files):
        made[f"{k:05d}.h5"] = fuzzed.write(sources[k % len(sources)], folder / f"{k:05d}.h5", random)
    environment = os.environ | {
        "CC": f"{compiler()} {SANITIZED}",
        "XDG_CACHE_HOME": str(cache),
        "LD_PRELOAD": " ".join(sanitizers()),
        "ASAN_OPTIONS": "detect_leaks=0:detect_stack_use_after_return=0",
        "PYTHONPATH": str(ROOT),
        "OPENBLAS_NUM_THREADS": "1",
    }
    command = [sys.executable, "-m", "tests.rom.fuzzed", str(folder)]
    done = subprocess.run(command, env=environment, cwd=ROOT, capture_output=True, text=True)
    if done.returncode:
        last = (folder / "last").read_text() if (folder / "last").exists() else "none"
        pytest.fail(f"{last} ({made.get(last)}): {done.stderr[-3000:]}")
    return json.loads(done.stdout)


needs_sanitizers = pytest.mark.skipif(not compiler() or not sanitizers(), reason="needs gcc's sanitizers")


@pytest.fixture(scope="module")
def cache(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("sanitized")


@pytest.mark.long
@needs_sanitizers
def test_two_hundred_wrong_files_are_refused_or_answered(sources, tmp_path, cache):
    found = counted(sources, tmp_path, cache, 200, seed=2)
    assert found["wrong"] == [] and found["refused"] + found["answered"] == 200
    assert found["answered"] > 10 and found["refused"] > 100


@pytest.mark.long
@needs_sanitizers
def test_right_files_are_answered_under_sanitizers(sources, tmp_path, cache):
    for k, source in enumerate(sources):
        (tmp_path / f"{k}.h5").write_bytes(source.read_bytes())
    assert counted([], tmp_path, cache, 0, seed=0) == {"answered": len(sources), "wrong": []}


def test_limits_are_those_of_the_compiled_code():
    lib, other = LIBRARY.functions, LIBRARY.functions
    found = lib.FINGERFEM_MOST_TENSIONS, lib.FINGERFEM_MOST_POWER, lib.FINGERFEM_WRENCH, lib.FINGERFEM_CORNERS
    known = rod_limits.MOST_TENSIONS, rod_limits.MOST_POWER, rod_limits.WRENCH, rod_limits.CORNERS
    assert found == known and lib.FINGERFEM_MOST_PLATES == MOST_SEGMENTS
    assert rod_limits.MOST_VARIANTS == lib.FINGERFEM_MOST_VARIANTS
    assert other.FINGERFEM_MOST_PARAMETERS == MOST_PARAMETERS == lib.FINGERFEM_MOST_TENSIONS + 1


def changed(source: Path, target: Path, change) -> Path:
    """A copy of a file that a function has changed, with a right checksum."""
    import h5py

    target.write_bytes(source.read_bytes())
    with h5py.File(target, "r+") as file:
        change(file)
    contents = target.read_bytes()
    target.write_bytes(fuzzed.with_checksum(contents, contents.split(b"\n")[0]))
    return target


def ninth_tendon(file) -> None:
    """Seven more at one place, that nothing depends on."""
    elements = file["elements"]
    for of in (file, elements):
        scene = json.loads(of.attrs["scene"])
        first = scene["tendons"][0]
        scene["tendons"] += [first | {"name": f"G{k}", "offset": [1e-3 * k, 1e-3]} for k in range(7)]
        of.attrs["scene"] = json.dumps(scene)
    for kind in elements:
        for group in (elements[kind], elements[kind]["outline"], elements[kind]["variants"]):
            widened(group, "powers", np.zeros((1, 7), int), at=2)
            widened(group, "box", np.repeat(group["box"][:, :1], 7, axis=1), at=2)
        widened(elements[kind], "tensions", np.repeat(elements[kind]["tensions"][:, :1], 7, axis=1), at=2)
        widened(elements[kind], "coefficients", np.zeros((1, 7)), at=8)
        del elements[kind]["tension_map"]
        elements[kind]["tension_map"] = np.eye(9)


def widened(group, name: str, columns: np.ndarray, at: int) -> None:
    """Insert columns into a dataset."""
    values = group[name][()]
    del group[name]
    more = np.broadcast_to(columns, (len(values), columns.shape[1]))
    group[name] = np.hstack([values[:, :at], more, values[:, at:]])


def power(file) -> None:
    file["elements/plate/powers"][0, 0] = 32


def far_away(file) -> None:
    file["elements/clamp/coefficients"][...] = 1e200 * file["elements/clamp/coefficients"][()].astype(float)


def swapped_map(file) -> None:
    file["elements/clamp/tension_map"][...] = [[0.0, 1.0], [1.0, 0.0]]


def without_interior(file) -> None:
    del file["elements/interior"]


def attribute(of: str, name: str, change):
    """A change of plain data in an attribute."""

    def made(file) -> None:
        group = file if of == "/" else file[of]
        plain = json.loads(group.attrs[name])
        change(plain)
        group.attrs[name] = json.dumps(plain)

    return made


def cut_variant(file) -> None:
    swap(file["elements/interior/variants"], lambda values: values[:, :-1])


def more_variants(file) -> None:
    for kind in file["elements"]:
        swap(file["elements"][kind]["variants"], lambda values: np.tile(values[:, :6], (1, 9)))


def swap(group, change) -> None:
    values = group["coefficients"][()]
    del group["coefficients"]
    group["coefficients"] = change(values)


REFUSED = {
    "nine tendons": (ninth_tendon, "tendons and chambers must be at most 8 of a rod, got 9"),
    "a power of 32": (power, "powers of law 0 must be from 0 to 31, got 0 to 32"),
    "a plate far away": (far_away, "free plate 1 must be within 2 lengths of its clamp, got "),
    "another map of tensions": (swapped_map, "tensions of all elements must have one box, got "),
    "no interior element": (without_interior, "geometry.segments.0: segment must be "),
    "no errors": (
        attribute("elements", "provenance", lambda plain: plain["left_out"].pop("free_place_m")),
        "left_out of provenance must have the median of free_place_m, finite and at least 0, got None",
    ),
    "variants of one element alone": (
        lambda file: file["elements/clamp"].__delitem__("variants"),
        "variants must be as many of all laws, or none, got ",
    ),
    "part of a variant": (
        cut_variant,
        "variants of interior must have 6 values each, got ",
    ),
    "too many variants": (more_variants, "variants must be from 1 to 8, got 9"),
    "a length that is none": (
        attribute("/", "scene", lambda plain: plain["geometry"].update(plate=-1.0)),
        "geometry.plate must be finite and above 0 m, got -1.0",
    ),
    "an endless finger": (
        attribute("/", "scene", lambda plain: plain["geometry"].update(segments=[1e300])),
        "geometry.segments.0: segment must be at most ",
    ),
    "no tendons": (
        attribute("/", "scene", lambda plain: plain.update(tendons=[])),
        "tendons must pass all segments, one at least of segment 1, got 0",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_rod_that_cannot_be_is_refused_by_name_and_rule(tmp_path, name):
    change, rule = REFUSED[name]
    file = changed(SHIPPED, tmp_path / "changed.h5", change)
    with pytest.raises(ModelError) as refused:
        Rod.load(file)
    assert str(refused.value).startswith(f"{file}: {rule}") and "\n" not in str(refused.value)


def swapped(file) -> None:
    values = file["free/functions_0"][()]
    del file["free/functions_0"]
    file["free/functions_0"] = values.transpose(0, 2, 1)


def another_side(file) -> None:
    cells = file["answered"][()]
    del file["answered"]
    file["answered"] = cells[:-1]


def number_as_name(file) -> None:
    parameters = json.loads(file.attrs["parameters"])
    parameters[1]["name"] = 1e300
    file.attrs["parameters"] = json.dumps(parameters)


def without_force(file) -> None:
    values = file["contact/modes"][:3]
    del file["contact/modes"]
    file["contact/modes"] = values


OF_TABLES = {
    "cells that are not a cube": (another_side, "cells must be as many along each of 3 parameters, got "),
    "no contact force": (without_force, "contact must have 4 to 5 components, got 3"),
    "axes the other way round": (swapped, "functions_0 of free must have shape (2, "),
    "a number as a name": (number_as_name, "parameters must have text as names and units, got ["),
}


@pytest.mark.parametrize("name", OF_TABLES)
def test_a_separated_model_beyond_compiled_code_is_refused_by_name_and_limit(table_file, tmp_path, name):
    change, rule = OF_TABLES[name]
    file = changed(table_file, tmp_path / "changed.h5", change)
    with pytest.raises(ModelError) as refused:
        SeparatedModel.load(file)
    assert str(refused.value).startswith(f"{file}: {rule}") and "\n" not in str(refused.value)
