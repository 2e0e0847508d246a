"""In the environment, each package that a command needs is named in one line when it alone is missing."""

import json
import subprocess
import sys

import pytest
from farm import ROOT
from plain_environment import run_without

SCENE = "scenes/draft.toml"
NEEDED_BY = {
    "mpi4py": ["solve", SCENE],
    "petsc4py": ["solve", SCENE],
    "dolfinx": ["solve", SCENE],
    "ufl": ["solve", SCENE],
    "pydantic": ["sketch", SCENE, "{}/picture.png"],
    "matplotlib": ["sketch", SCENE, "{}/picture.png"],
    "rich": ["snapshots", SCENE, "{}/set"],
    "pyvista": ["render", SCENE, "{}/picture.png", "--case", "F1=50"],
}


@pytest.mark.parametrize("package", NEEDED_BY)
def test_a_package_that_is_missing_is_one_line_before_anything_is_solved(package, tmp_path):
    done = run_without([package], "fingerfem", *(word.format(tmp_path) for word in NEEDED_BY[package]))
    assert done.returncode == 2 and done.stdout == "", done.stderr
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"{package} is not installed: docker/run python3 -m fingerfem ... has it"), line
    assert list(tmp_path.iterdir()) == []


def test_a_picture_of_a_solved_state_is_refused_before_it_is_solved(tmp_path):
    for option in ("--picture", "--paraview"):
        done = run_without(["pyvista"], "fingerfem", "solve", SCENE, "F1=50", option, tmp_path / "finger.vtu")
        assert done.returncode == 2 and done.stderr.startswith("pyvista is not installed"), done.stderr


@pytest.mark.long
def test_every_module_imports_and_every_command_has_help():
    line = [sys.executable, "tests/packaging/installed.py"]
    done = subprocess.run(line, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    missing = {package for package in json.loads(done.stdout.splitlines()[-1]).values() if package}
    assert missing <= {"mujoco", "gymnasium"}
