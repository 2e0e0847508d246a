"""Compiled code is built once, by any number of processes, and never older than its sources."""

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from control.native import CONTROL
from rom.native import LIBRARY, Library, NoCompiler
from rom.native.library import FEATURES, LINE, processor

ROOT = Path(__file__).resolve().parents[3]
HALF = "double {name}(double x);\n", "double {name}(double x) {{ return {factor} * x; }}\n"
USE = "from rom.native import LIBRARY; print(bool(LIBRARY.functions.fingerfem_answer))"


def sample(folder: Path, factor: float) -> Library:
    header, source = (text.format(name="scaled", factor=factor) for text in HALF)
    (folder / "sample.h").write_text("#define NOTHING\n" + header)
    (folder / "sample.c").write_text('#include "sample.h"\n' + source)
    return Library("sample", folder, ["sample.h"], [folder / "sample.c"])


def without(cache: Path, **settings: str) -> dict[str, str]:
    """An environment whose cache holds nothing, as on a new machine."""
    return os.environ | {"XDG_CACHE_HOME": str(cache), "PYTHONPATH": str(ROOT)} | settings


def test_a_library_is_built_once_and_again_when_its_source_changes(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    assert sample(tmp_path, 0.5).functions.scaled(3.0) == 1.5
    (first,) = (tmp_path / "cache").rglob("*.so")
    made = first.stat().st_mtime_ns
    assert sample(tmp_path, 0.5).functions.scaled(3.0) == 1.5
    assert first.stat().st_mtime_ns == made
    assert sample(tmp_path, 21).functions.scaled(2.0) == 42
    assert len(list((tmp_path / "cache").rglob("*.so"))) == 2


def test_a_library_beside_its_sources_is_taken_and_nothing_is_built(tmp_path, monkeypatch):
    sample(tmp_path, 2.0).build(tmp_path, processor())
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("CC", "no-such-compiler")
    assert sample(tmp_path, 2.0).functions.scaled(3.0) == 6
    assert not (tmp_path / "cache").exists()


@pytest.mark.long
def test_many_processes_may_build_at_once_in_a_cold_cache(tmp_path):
    command, environment = [sys.executable, "-c", USE], without(tmp_path)
    jobs = [
        subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for _ in range(4)
    ]
    jobs[0].kill()
    jobs[0].communicate()
    assert [job.communicate() for job in jobs[1:]] == [("True\n", "")] * 3
    assert len(list(tmp_path.rglob("*.so"))) == 1
    done = subprocess.run(command, env=environment | {"CC": "no-such-compiler"}, capture_output=True, text=True)
    assert done.stdout == "True\n"  # kept


@pytest.mark.parametrize("missing", [{"PATH": "/nowhere"}, {"CC": "false"}, {"CC": "no-such-compiler"}])
def test_without_a_library_and_a_compiler_the_command_says_so_in_one_line(tmp_path, missing):
    command = [sys.executable, "-m", "control", "hold", "rom/finger.h5", "--distance", "0.01"]
    done = subprocess.run(command, env=without(tmp_path, **missing), capture_output=True, text=True)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert "C compiler must" in line and "got" in line


@pytest.mark.long
def test_a_cache_that_cannot_be_written_to_is_done_without(tmp_path):
    (tmp_path / "file").write_text("no folder")
    done = subprocess.run([sys.executable, "-c", USE], env=without(tmp_path / "file"), capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("True\n", "")


@pytest.mark.long
def test_levels_of_the_processor_are_each_a_library_of_the_same_functions(tmp_path):
    if not processor():
        pytest.skip("levels are those of x86-64 with AVX2")
    found = []
    for level in ("", *FEATURES):
        if level <= processor():  # the others would not run here
            (tmp_path / level).mkdir(exist_ok=True)
            file = LIBRARY.build(tmp_path / level, level)
            found.append(LIBRARY.ffi.dlopen(str(file)).fingerfem_answers)
    assert len(found) >= 2


def test_a_source_that_does_not_compile_is_one_line(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    library = sample(tmp_path, 1.0)
    (tmp_path / "sample.c").write_text("this is no C\n")
    with pytest.raises(NoCompiler, match="must build sample") as refused:
        _ = library.functions
    assert "\n" not in str(refused.value)
    assert not list((tmp_path / "cache").rglob("*.so"))


def test_constants_are_those_of_the_headers_and_need_no_compiler(tmp_path, monkeypatch):
    library = sample(tmp_path, 1.0)
    monkeypatch.setenv("CC", "no-such-compiler")
    (tmp_path / "sample.h").write_text(
        "enum { SAMPLE_FIRST = 3, SAMPLE_SECOND };\n" + (tmp_path / "sample.h").read_text()
    )
    assert (library.constants.SAMPLE_FIRST, library.constants.SAMPLE_SECOND) == (3, 4)


def test_the_sources_allocate_nothing_and_keep_no_state():
    for library in (LIBRARY, CONTROL):
        for file in library.folder.rglob("*.[ch]"):
            text = re.sub(r"/\*.*?\*/", "", file.read_text(), flags=re.DOTALL)
            assert not re.search(r"\b(malloc|calloc|realloc|alloca)\b", text), file
            assert not re.search(r"^static (?!inline|const)[^(]*[;=]", text, re.MULTILINE), file


def test_arrays_of_structs_begin_with_a_cache_line():
    """Vectors of as many bytes then lie in one line each."""
    found = LIBRARY.struct("fingerfem_tables", data=np.arange(3.0))
    assert int(LIBRARY.ffi.cast("uintptr_t", found.data)) % LINE == 0 and list(found.data[0:3]) == [0.0, 1.0, 2.0]
