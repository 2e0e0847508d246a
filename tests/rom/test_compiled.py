"""Compiled functions are kept on disk, but never older than any source that is in them."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numba.core.errors import NumbaError

from rom.compiled import compiled

ROOT = Path(__file__).resolve().parents[2]
CALLED = """
from typing import NamedTuple
from rom.compiled import compiled


class {name}(NamedTuple):
    number: int


@compiled
def number(of):
    return {factor} * of.number


kept = {name}(1)
"""
CALLER = """
from rom.compiled import compiled
from {package}.called import number


@compiled
def twice(of):
    return 2 * number(of)
"""


def run(folder, package):
    code = (
        f"from {package}.caller import twice; from {package}.called import kept; result = twice(kept); "
        "print(result, sum(twice.stats.cache_hits.values()))"
    )
    environment = {"PYTHONPATH": f"{folder}:{ROOT}", "PATH": "/usr/bin:/bin"}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=True)
    return tuple(int(word) for word in done.stdout.split())


def test_what_is_called_changes_and_the_caller_is_compiled_again(tmp_path):
    package = tmp_path / "sample_package"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "called.py").write_text(CALLED.format(name="Before", factor=1))
    (package / "caller.py").write_text(CALLER.format(package="sample_package"))
    assert run(tmp_path, "sample_package") == (2, 0)
    assert run(tmp_path, "sample_package") == (2, 1)  # kept on disk
    (package / "called.py").write_text(CALLED.format(name="After", factor=21))
    assert run(tmp_path, "sample_package") == (42, 0)


def test_what_is_not_said_to_allocate_does_not():
    @compiled
    def secretly(n):
        return np.zeros(n).sum()

    with pytest.raises(NumbaError):
        secretly(3)


def test_what_has_no_source_file_is_compiled_but_not_kept():
    names: dict = {"compiled": compiled}
    exec("@compiled\ndef half(x):\n    return x / 2\n", names)
    assert names["half"](3.0) == 1.5 and not names["half"].stats.cache_path
