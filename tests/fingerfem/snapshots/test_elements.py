"""Elements trained on one finger make fingers of other lengths, as the full-order model solves them."""

import json
import os
import subprocess
import sys
import tomllib

import numpy as np
import pytest
from farm import ROOT, run

from fingerfem import FingerModel
from fingerfem.scene.scene import Scene
from rom.rod.rod import Rod

CELL = 0.003  # along the axis, in all of these fingers [m]
TRAINED, FORCE = 0.049, 4.0
LENGTHS = 0.0265, 0.037, 0.067  # of which the first has interior elements shorter than a cell [m]


def scene_text(segments: list[float], lines: int = 20, tension: float = 60.0) -> str:
    text = (ROOT / "scenes" / "pressed.toml").read_text()
    cells = round((segments[0] - 0.001) / CELL) + 1
    for before, after in (
        ("segments = [0.050]", f"segments = {segments}"),
        ("force = 5.0", f"force = {FORCE}\nmoment = 0.1"),
        ("cells = [20, 5]", f"cells = [{cells}, 5]"),
        ("lines = 24", f"lines = {lines}"),
        ("tension = [0.0, 100.0]", f"tension = [0.0, {tension}]"),
    ):
        assert before in text
        text = text.replace(before, after)
    return text


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    folder = tmp_path_factory.mktemp("elements")
    (folder / "scene.toml").write_text(scene_text([TRAINED]))
    report = run(2, folder / "scene.toml", folder / "set")
    assert report["failed"] == 0
    return folder


@pytest.fixture(scope="module")
def finger(trained) -> Rod:
    command = [sys.executable, "-m", "rom", "build", "set", "-o", "finger.h5", "--json"]
    found = subprocess.run(command, cwd=trained, env=_environment(), capture_output=True, text=True)
    assert found.returncode == 0, found.stderr
    assert json.loads(found.stdout)["provenance"]["states"] == 100
    return Rod.load(trained / "finger.h5")


def _environment() -> dict[str, str]:
    return os.environ | {"PYTHONPATH": str(ROOT)}


@pytest.mark.long
def test_left_out_lines_are_predicted_within_a_ten_thousandth(finger):
    left_out = finger.elements.provenance["left_out"]
    assert left_out["contact_force"]["median"] < 1e-4 and left_out["contact_force"]["p95"] < 5e-4
    assert left_out["free_place_m"]["p95"] < 2e-6


@pytest.mark.long
@pytest.mark.parametrize("length", LENGTHS[1:3])
def test_a_finger_of_another_length_is_the_full_order_model_s(finger, trained, length):
    table = tomllib.loads(scene_text([length], tension=40.0))
    model, rod = FingerModel(Scene.model_validate(table)), finger.assembled(table)
    random, off, turned = np.random.default_rng(2), [], []
    for _ in range(6):
        tensions = random.uniform(0, 40, 2)
        force = random.uniform(-1, 1, 3)
        wrench = np.concatenate([force, np.cross([0.0005, 0.005, -0.005], force)])
        state = model.solve(tensions, wrenches=wrench[None], sensitivities=False)
        found = rod.place(tensions, wrench[None])
        assert found.inside
        off.append(np.linalg.norm(found.centres[0] - state.plate_centres[0]))
        turned.append(np.abs(found.rotations[0] - state.plate_rotations[0]).max())
    assert max(off) < 1.5e-6 and max(turned) < 4e-5


@pytest.mark.long
def test_the_command_refuses_what_elements_cannot_make_before_it_writes(trained, finger):
    (trained / "short.toml").write_text(scene_text([0.022]))
    command = [sys.executable, "-m", "rom", "assemble", "short.toml", "finger.h5", "-o", "short.h5"]
    found = subprocess.run(command, cwd=trained, env=_environment(), capture_output=True, text=True)
    assert found.returncode == 2 and not (trained / "short.h5").exists()
    assert (
        "geometry.segments.0: segment must be at least 0.0245 m long" in found.stderr
        and "Traceback" not in found.stderr
    )


@pytest.mark.long
def test_two_segments_with_tendons_that_end_at_either_plate(finger):
    """A rigid plate clamps the next segment; a tendon of the tip passes the first segment as if it ended there."""
    table = tomllib.loads(scene_text([0.037, 0.037], tension=30.0))
    table["tendons"][1]["segment"] = 2
    model, rod = FingerModel(Scene.model_validate(table)), finger.assembled(table)
    wrenches = np.array([[0.2, -0.4, 0.3, 2e-3, 0, 1e-3], [0.3, 0.2, -0.3, 0, -1e-3, 2e-3]])
    state = model.solve([20.0, 25.0], wrenches=wrenches, sensitivities=False)
    found = rod.place([20.0, 25.0], wrenches)
    np.testing.assert_allclose(found.centres, state.plate_centres, atol=1.5e-6)
    np.testing.assert_allclose(found.rotations, state.plate_rotations, atol=4e-5)
