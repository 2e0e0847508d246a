"""Files that are wrong are refused by name and limit, or answered without a wrong access to memory."""

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rom.segment import limits as segment_limits

from rom import Chain, SegmentMap, Surrogate, limits
from rom.checked_file import ModelError
from rom.native import EVALUATION, SEGMENT, compiler
from rom.rod.touched_segment import SHIPPED
from tests.rom import fuzzed

ROOT = Path(__file__).resolve().parents[2]
SANITIZED = "-g -fsanitize=address,undefined -fno-sanitize-recover=undefined"


def sanitizers() -> list[str]:
    """Where the compiler's run-time libraries are; none if it has none."""
    files = [
        subprocess.run([*compiler().split(), f"-print-file-name={name}"], capture_output=True, text=True).stdout.strip()
        for name in ("libasan.so", "libubsan.so")
    ]
    return files if all(Path(file).is_absolute() for file in files) else []


@pytest.fixture(scope="module")
def sources(tmp_path_factory, trained) -> list[Path]:
    """A map with all it may have and one without, a chain, and surrogates with a field and without."""
    folder = tmp_path_factory.mktemp("sources")
    whole = SegmentMap.load(SHIPPED)
    whole.without_displacements().save(folder / "map.h5")
    Chain([whole.without_displacements()] * 2).save(folder / "chain.h5")
    return [SHIPPED, folder / "map.h5", folder / "chain.h5", Path(SHIPPED).with_name("plane.h5"), trained / "finger.h5"]


def counted(sources: list[Path], folder: Path, cache: Path, files: int, seed: int) -> dict:
    """What came of so many wrong files, under sanitizers."""
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


@needs_sanitizers
def test_a_hundred_wrong_files_are_refused_or_answered(sources, tmp_path, cache):
    found = counted(sources, tmp_path, cache, 100, seed=1)
    assert found["wrong"] == [] and found["refused"] + found["answered"] == 100
    assert found["answered"] > 5 and found["refused"] > 50


@pytest.mark.long
@needs_sanitizers
def test_two_thousand_wrong_files_are_refused_or_answered(sources, tmp_path, cache):
    found = counted(sources, tmp_path, cache, 2000, seed=2)
    assert found["wrong"] == [] and found["refused"] + found["answered"] == 2000
    assert found["answered"] > 100 and found["refused"] > 1000


@needs_sanitizers
def test_right_files_are_answered_under_sanitizers(sources, tmp_path, cache):
    for k, source in enumerate(sources):
        (tmp_path / f"{k}.h5").write_bytes(source.read_bytes())
    assert counted([], tmp_path, cache, 0, seed=0) == {"answered": len(sources), "wrong": []}


def test_limits_are_those_of_the_compiled_code():
    lib, other = SEGMENT.functions, EVALUATION.functions
    found = lib.FINGERFEM_MOST_TENSIONS, lib.FINGERFEM_MOST_POWER, lib.FINGERFEM_WRENCH, lib.FINGERFEM_CORNERS
    known = segment_limits.MOST_TENSIONS, segment_limits.MOST_POWER, segment_limits.WRENCH, segment_limits.CORNERS
    assert found == known and lib.FINGERFEM_MOST_PLATES == 8
    assert other.FINGERFEM_MOST_PARAMETERS == limits.MOST_PARAMETERS == lib.FINGERFEM_MOST_TENSIONS + 1
    assert other.FINGERFEM_MOST_REGIMES == limits.MOST_REGIMES


def test_a_map_that_is_being_trained_is_refused_as_its_file_would_be():
    whole = SegmentMap.load(SHIPPED)
    powers = whole.pose.powers.copy()
    powers[0, 0] = 32
    with pytest.raises(ModelError, match="powers must be from 0 to 31, got 0 to 32"):
        _ = replace(whole, pose=replace(whole.pose, powers=powers)).struct


def changed(source: Path, target: Path, change) -> Path:
    """A copy of a file that a function has changed, with a right checksum."""
    import h5py

    target.write_bytes(source.read_bytes())
    with h5py.File(target, "r+") as file:
        change(file)
    contents = target.read_bytes()
    target.write_bytes(fuzzed.with_checksum(contents, contents.split(b"\n")[0]))
    return target


def ninth_tension(file) -> None:
    """Seven tensions more, that nothing depends on."""
    parameters = json.loads(file.attrs["parameters"])
    more = [parameters[0] | {"name": f"G{k}"} for k in range(7)]
    file.attrs["parameters"] = json.dumps(parameters[:2] + more + parameters[2:])
    for name in [one for one in file if one.endswith("powers")] + ["box"]:
        values = file[name][()]
        columns = np.repeat(values[:, :1] * (name == "box"), 7, axis=1)
        del file[name]
        file[name] = np.hstack([values[:, :2], columns, values[:, 2:]])


def power(file) -> None:
    values = file["powers"][()]
    values[0, 0] = 32
    file["powers"][...] = values


def not_a_number(file) -> None:
    file["coefficients"][0, 0] = np.nan


REFUSED = {
    "nine tensions": (ninth_tension, "tensions must be from 1 to 8, got 9"),
    "a power of 32": (power, "powers must be from 0 to 31, got 0 to 32"),
    "NaN": (not_a_number, "coefficients of powers must be finite"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_map_beyond_what_compiled_code_holds_is_refused_by_name_and_limit(sources, tmp_path, name):
    change, rule = REFUSED[name]
    file = changed(sources[1], tmp_path / "changed.h5", change)
    with pytest.raises(ModelError) as refused:
        SegmentMap.load(file)
    assert str(refused.value).startswith(f"{file}: {rule}") and "\n" not in str(refused.value)


def more_regimes(file) -> None:
    """Copies of the first one."""
    for k in range(64):
        if f"regime_{k}" not in file["contact"]:
            file.copy("contact/regime_0", f"contact/regime_{k}")
    file.copy("contact/regime_0", "contact/regime_64")


def unknown_regime(file) -> None:
    file["contact/map"][0, 0, 0] = 200


def swapped(file) -> None:
    values = file["free/values_0"][()]
    del file["free/values_0"]
    file["free/values_0"] = values.T


OF_SURROGATES = {
    "more regimes than bits": (more_regimes, "regimes must be at most 64, got 65"),
    "a regime that there is not": (unknown_regime, "map must be of regimes 0 to "),
    "axes the other way round": (swapped, "values_0 and slopes_0 of free must have shape (nodes, "),
}


@pytest.mark.parametrize("name", OF_SURROGATES)
def test_a_surrogate_beyond_what_compiled_code_holds_is_refused_by_name_and_limit(sources, tmp_path, name):
    change, rule = OF_SURROGATES[name]
    file = changed(sources[3], tmp_path / "changed.h5", change)
    with pytest.raises(ModelError) as refused:
        Surrogate.load(file)
    assert str(refused.value).startswith(f"{file}: {rule}") and "\n" not in str(refused.value)
