"""The C sources: without warnings; and includes run one way."""

import re
import subprocess
from pathlib import Path

import pytest

from control.native import CONTROL
from rom.native import LIBRARY, compiler

ROOT = Path(__file__).parents[3]
STRICT = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-fsyntax-only"]
UNITS = [*LIBRARY.units, *CONTROL.units, *sorted((ROOT / "control" / "export" / "native").glob("standalone.c"))]


def includes(file: Path) -> list[Path]:
    """The files of the project that a source includes."""
    names = re.findall(r'^\s*#\s*include\s+"([^"]+)"', file.read_text(), re.MULTILINE)
    return [(file.parent / name).resolve() for name in names]


@pytest.mark.parametrize("unit", UNITS, ids=lambda unit: f"{unit.parts[-3]}/{unit.name}")
def test_a_unit_compiles_without_a_warning(unit):
    done = subprocess.run([*compiler().split(), *STRICT, str(unit)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_no_source_of_models_includes_one_of_controllers():
    sources = [file for kind in ("*.c", "*.h", "*.in") for file in (ROOT / "rom").rglob(kind)]
    found = [(file, one) for file in sources for one in includes(file)]
    assert len(found) > 50 and all(one.is_relative_to(ROOT / "rom") for _, one in found)
