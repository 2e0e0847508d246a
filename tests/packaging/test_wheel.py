"""A wheel brings the compiled part: where it is installed, nothing needs a compiler."""

import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from rom.bundled import FINGERS
from rom.console.packages import REMEDIES
from rom.native import levels
from tests.packaging.installed import PROGRAMS, modules_of

ROOT = Path(__file__).resolve().parents[2]
INSTALLED = Path(__file__).with_name("installed.py")
CLEAN = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}  # not the checkout
SIMULATION = ("mujoco", "gymnasium")  # extras
HOLD = """
from control import Finger
import rom
print(Finger(rom.load()).hold(1.0, 0.010).status, rom.__file__)
"""


def pip(*words: object, python: object = sys.executable) -> None:
    command = [str(python), "-m", "pip", "-q", "--disable-pip-version-check", *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, env=CLEAN)
    assert done.returncode == 0, done.stderr


def test_a_wheel_holds_a_force_without_a_compiler(tmp_path):
    pip("wheel", "--no-deps", "-w", tmp_path, ROOT)
    (wheel,) = tmp_path.glob("*.whl")
    pip("install", "--no-deps", "--target", tmp_path / "installed", wheel)
    settings = {
        "PYTHONPATH": str(tmp_path / "installed"),
        "PATH": "/nowhere",
        "XDG_CACHE_HOME": str(tmp_path / "cache"),
    }
    done = subprocess.run([sys.executable, "-c", HOLD], cwd=tmp_path, env=settings, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    status, place = done.stdout.split()
    assert status == "converged" and place.startswith(str(tmp_path))
    assert not (tmp_path / "cache").exists()  # nothing was built
    assert len(list((tmp_path / "installed").rglob("*.so"))) == 2 * len(levels())  # of rom and of control
    assert {file.stem for file in (tmp_path / "installed").rglob("*.h5")} == FINGERS.keys()
    settings = os.environ | {"PYTHONPATH": str(tmp_path / "installed")}
    done = subprocess.run([sys.executable, str(INSTALLED)], cwd=tmp_path, env=settings, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout.splitlines()[-1]).keys() == modules()


def modules() -> set[str]:
    """All modules of the checkout that are in a wheel."""
    return {name for program in PROGRAMS for name in modules_of(ROOT / program)}


def bounds() -> dict[str, str]:
    """The oldest version of every package that pyproject.toml allows at run time and for simulations."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    allowed = project["dependencies"] + [one for extra in SIMULATION for one in project["optional-dependencies"][extra]]
    return dict(re.fullmatch(r"([\w-]+)>=([\d.]+)", one).groups() for one in allowed)


@pytest.mark.long
@pytest.mark.parametrize("which", ["oldest", "newest"])
def test_a_clean_environment_works_with_the_oldest_and_the_newest_versions_allowed(tmp_path, which):
    pip("wheel", "--no-deps", "-w", tmp_path, ROOT)
    (wheel,) = tmp_path.glob("*.whl")
    python = tmp_path / "venv" / "bin" / "python"
    subprocess.run([sys.executable, "-m", "venv", str(tmp_path / "venv")], check=True)
    oldest = [f"{name}=={version}" for name, version in bounds().items()] if which == "oldest" else []
    pip("install", f"{wheel}[{','.join(SIMULATION)}]", *oldest, python=python)
    line = [str(python), str(INSTALLED), "simulated"]
    done = subprocess.run(line, cwd=tmp_path, env=CLEAN, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.splitlines()[-1])
    assert found.keys() == modules()
    needs = {package for package in found.values() if package}
    assert needs and needs <= REMEDIES.keys() - {"mujoco", "gymnasium"}
    assert not [name for name, package in found.items() if package and not name.startswith("fingerfem.")]
