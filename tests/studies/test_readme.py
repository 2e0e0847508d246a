"""README does what it says."""

import os
import re
import subprocess
import sys
from pathlib import Path

from fingerfem.scene.scene import Scene

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text()


QUICK_START, EXAMPLE = re.findall(r"```python\n(.*?)```", README, re.DOTALL)


def test_the_quick_start_needs_five_lines_and_what_is_in_the_repository(tmp_path):
    assert len([line for line in QUICK_START.splitlines() if line]) <= 5
    settings = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", QUICK_START], cwd=tmp_path, env=settings, capture_output=True, text=True
    )
    assert done.returncode == 0 and done.stdout.startswith("converged"), done.stderr
    (command,) = re.findall(r"^python3 -m control hold.*$", README, re.MULTILINE)
    words = [sys.executable, *command.split()[1:]]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.startswith("converged"), done.stderr


def test_the_python_example_runs_and_holds_the_force(demo):
    code = EXAMPLE
    assert 10 <= len([line for line in code.splitlines() if line]) <= 15
    code = code.replace("out/demo", str(demo)).replace("scenes/standard.toml", "scenes/draft.toml")  # what tests train
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    first, *_, last = done.stdout.splitlines()
    assert first.startswith("converged")
    assert abs(float(last.split()[0]) - 1.0) < 0.05


def test_the_table_of_parameters_names_every_key_of_a_scene():
    assert "| `name` |" in README
    listed = set(re.findall(r"^\| `(\w+)\.(\w+)`", README, re.MULTILINE))
    schema = Scene.model_json_schema()["$defs"]
    tables = {
        "geometry": ["Geometry"],
        "tendons": ["Tendon"],
        "obstacle": ["Obstacle"],
        "mesh": ["Mesh"],
        "load": ["Load"],
        "coarse": ["Coarse"],
    }
    tables |= {"material": ["NeoHookean", "MooneyRivlin", "SaintVenantKirchhoff"], "sampling": ["Sampling"]}
    keys = {(table, key) for table, names in tables.items() for name in names for key in schema[name]["properties"]}
    assert listed == keys


def test_the_two_commands_are_those_of_the_makefile_and_of_ci():
    assert "make demo " in README and "make test " in README
    targets = re.findall(r"^(\w+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
    assert {"demo", "test", "clean"} <= set(targets)
    ci = [line for line in (ROOT / ".ci" / "run").read_text().splitlines() if line and line[0] != "#"]
    assert ci[-2:] == ["make test", "make test-long"] and len(ci) == 4
    assert "make test-long" in README


def test_the_measured_block_was_written():
    from studies.readme import BEGIN, END

    block = README.split(BEGIN)[1].split(END)[0]
    assert "contact force" in block and "%" in block
