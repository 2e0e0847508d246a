"""The tutorials that train do so, on coarse meshes; code that needs the full-order model runs."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

from rom import Rod

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
COARSE = """
[mesh]
cells = [16, 5]

[coarse]
cells = [10, 5]
lines = 12

[sampling]
lines = 6
"""
RUN = {"cwd": ROOT, "capture_output": True, "text": True}


@pytest.fixture(scope="module")
def page() -> str:
    return (DOCS / "tutorials" / "your-finger.md").read_text()


@pytest.mark.long
def test_the_scene_of_the_tutorial_trains_a_finger_that_holds_a_force(page, tmp_path):
    (scene,) = re.findall(r'```toml title="mine/finger.toml"\n(.*?)```', page, re.DOTALL)
    assert 'preset = "draft"' in scene
    scene = re.sub(r"^preset = .*$", "", scene, flags=re.MULTILINE)
    (tmp_path / "finger.toml").write_text(scene + COARSE)
    commands = re.findall(r"^docker/run (.*)$", page, re.MULTILINE)
    assert [re.search(r"-m (\w+ \w+)", line)[1] for line in commands] == [
        "fingerfem solve",
        "fingerfem snapshots",
        "fingerfem snapshots",
        "rom build",
        "fingerfem snapshots",
        "rom check",
        "fingerfem certify",
    ]
    printed = {}
    for line in commands:
        words = line.replace("mine/", f"{tmp_path}/").replace("python3", sys.executable).split()
        done = subprocess.run(words, env=os.environ | {"PYTHONPATH": str(ROOT)}, **RUN)
        printed[line] = done.stdout
        # So few states may not cover a force that somebody chose.
        assert done.returncode in ((0, 3) if "certify" in line else (0,)), done.stderr
    assert "contact_force" in printed[commands[-1]] or "contact force" in printed[commands[-1]]
    (code,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    done = subprocess.run([sys.executable, "-c", code.replace("mine/", f"{tmp_path}/")], **RUN)
    assert done.returncode == 0 and done.stdout.startswith("converged"), done.stderr


def test_the_scene_of_the_tutorial_is_what_its_preset_takes(page):
    from fingerfem.scene.scene import Scene

    (scene,) = re.findall(r'```toml title="mine/finger.toml"\n(.*?)```', page, re.DOTALL)
    chosen = Scene.model_validate(tomllib.loads(scene))
    assert chosen.expected is not None and chosen.coarse is not None


@pytest.mark.long
def test_a_held_force_is_that_of_the_full_order_model(demo):
    (code,) = re.findall(r"```python\n(.*?)```", (DOCS / "howto" / "trust.md").read_text(), re.DOTALL)
    code = code.replace("out/demo", str(demo)).replace("scenes/standard.toml", "scenes/draft.toml")  # what tests train
    done = subprocess.run([sys.executable, "-c", code], **RUN)
    assert done.returncode == 0, done.stderr
    assert abs(float(done.stdout.splitlines()[-1].split()[0]) - 1.0) < 0.05


@pytest.mark.long
def test_a_test_of_a_material_becomes_a_hanging_finger_that_holds_a_force(tmp_path):
    smaller = {"cells = [20, 5]": "cells = [14, 5]", "lines = 16": "lines = 8\nwrenches = 2"}
    assert followed(of_material()[0], smaller, tmp_path).startswith("converged")


@pytest.mark.long
def test_the_log_of_a_softer_robot_calibrates_a_long_tapered_finger(tmp_path):
    """The robot, the full-order model of half the length, has a tenth less modulus: found within its meshes' error."""
    from fingerfem import FingerModel
    from fingerfem.scene.scene import Scene

    page = of_material()[1].replace("segments = [0.180, 0.180]", "segments = [0.090, 0.090]")
    (scene,) = re.findall(r'```toml title="mine/tapered.toml"\n(.*?)```', page, re.DOTALL)
    (columns,) = re.findall(r"```text\n(.*?)```", page, re.DOTALL)
    table = tomllib.loads(scene) | {"mesh": {"cells": [16, 5]}}
    table["material"] |= {"C1": 0.9 * table["material"]["C1"], "D1": table["material"]["D1"] / 0.9}
    robot, rows = FingerModel(Scene.model_validate(table)), [columns.strip()]
    geometry = robot.scene.geometry
    rest = np.array([geometry.length - geometry.half_lengths[-1, 0], 0.0, 0.0])
    for tensions in ([0.0, 0.0], [0.4, 0.0], [0.0, 0.6]):
        tip = robot.solve(tensions, sensitivities=False).tip + rest
        rows.append(",".join(map(str, [*tensions, *(1000 * tip)])))
    (tmp_path / "log.csv").write_text("\n".join(rows))
    smaller = {"cells = [16, 5]": "cells = [7, 5]", "lines = 16": "lines = 8\nwrenches = 3"}
    assert followed(page, smaller, tmp_path).startswith("True")
    modulus = Rod.load(tmp_path / "calibrated.h5").calibration["parameters"]["modulus"]
    assert modulus["value"] / modulus["start"] == pytest.approx(0.9, abs=0.05)


def of_material() -> list[str]:
    """The tutorial of a material, and its section of a tapered finger."""
    return (DOCS / "tutorials" / "your-material.md").read_text().split("## 6.")


def followed(page: str, smaller: dict[str, str], folder: Path) -> str:
    """Output of a tutorial's last code, after its files and commands in their order, with texts replaced."""
    page = page.replace("mine/", f"{folder}/")
    assert all(page.count(text) == 1 for text in smaller)
    for before, after in smaller.items():
        page = page.replace(before, after)
    for kind, file, block in re.findall(r'^```(\w+)(?: title="(.*?)")?\n(.*?)^```', page, re.DOTALL | re.MULTILINE):
        if file:
            Path(file).write_text(block)
        if file or kind not in ("bash", "python"):
            continue
        for line in block.splitlines() if kind == "bash" else [f"python3 -c '{block}'"]:
            words = line.removeprefix("docker/run ").replace("python3", sys.executable)
            done = subprocess.run(words, shell=True, env=os.environ | {"PYTHONPATH": str(ROOT)}, **RUN)
            assert done.returncode == 0, done.stderr
    return done.stdout
