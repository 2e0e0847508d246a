"""What a surrogate answers beside the full-order model that begins at its field."""

import json
import subprocess
import sys

import numpy as np
import pytest
from farm import ROOT

from fingerfem import FingerModel, load_scene
from fingerfem.certify import Certifier, full_order_scene
from rom import TouchedSegment


@pytest.fixture(scope="module")
def certificates(surrogate):
    certifier, (lower, upper) = Certifier(surrogate), surrogate.limits
    points = lower + np.random.default_rng(0).random((24, 3)) * (upper - lower)
    return points, [certifier.certify(point[:-1], float(point[-1])) for point in points]


def test_the_truth_is_that_from_rest(certificates):
    full_order = FingerModel(load_scene(ROOT / "scenes" / "draft.toml"))
    began = {one.began for one in certificates[1]}
    assert {"field", "free"} <= began
    for kind in sorted(began):
        point, found = next(pair for pair in zip(*certificates, strict=True) if pair[1].began == kind)
        state = full_order.solve(point[:-1], point[-1], sensitivities=False)
        assert np.abs(state.tip - found.tip).max() < 1e-8
        assert abs(state.contact_force - found.contact_force) < 1e-4


def test_most_need_a_few_factorisations_and_are_covered(certificates):
    found = certificates[1]
    assert np.median([one.factorisations for one in found]) <= 4
    assert np.mean([one.began == "field" for one in found]) > 0.6
    assert np.mean([one.covered for one in found]) >= 0.85
    assert sum(one.contact_force > 0 for one in found) > 8


def test_a_free_finger_is_certified_too(surrogate):
    found = Certifier(surrogate).certify([40.0, 10.0])
    assert found.contact_force is None and found.factorisations <= 4
    assert found.errors["tip"] < 1e-5 and found.covered


def test_a_finger_of_elements_is_compared_on_the_mesh_that_corrected_it():
    """On the mesh of its training a corrected finger would seem off by what these meshes differ by."""
    bundled = TouchedSegment.load()
    found, finer = full_order_scene(bundled), bundled.rod.elements.provenance["corrected_by"]
    assert found["mesh"]["cells"] == finer["cells"] == [32, 7] and found["mesh"]["order"] == finer["order"]
    assert bundled.scene["mesh"]["cells"] == [24, 6] and "load" not in found


def test_a_longer_finger_has_as_long_cells():
    """Cells as long as its trained finger's would be coarse."""
    bundled = TouchedSegment.load()
    geometry = bundled.scene["geometry"] | {"segments": [0.1, 0.06]}
    tendons = [tendon | {"segment": 2} for tendon in bundled.scene["tendons"]]
    rod = bundled.rod.assembled(bundled.scene | {"geometry": geometry, "tendons": tendons})
    assert full_order_scene(TouchedSegment(rod=rod, obstacle=bundled.obstacle))["mesh"]["cells"] == [64, 7]


def run(*words: str) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "fingerfem", "certify", *map(str, words)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True)


def test_the_command_prints_both_answers_and_refuses_in_one_line(trained):
    point = "F1=50", "F2=20", "d=0.010"
    done = run(trained / "finger.h5", *point, "--json")
    found = json.loads(done.stdout)
    force, tip = found["contact_force"], found["tip"]
    assert force["error"] == pytest.approx(abs(force["answer"] - force["full_order"]))
    # Estimates cover 95 % of states: this one may be among the others.
    assert found["inside"] and force["error"] < 2 * force["estimated_error"]
    assert found["covered"] == all(one["error"] <= one["estimated_error"] for one in (force, tip))
    assert done.returncode == (0 if found["covered"] else 3)
    shown = run(trained / "finger.h5", *point)
    assert shown.returncode == done.returncode and "estimated_error" in shown.stdout
    for words, said in (
        ((trained / "finger.h5", "F1=500"), "F1 must lie in [0, 100] N"),
        ((ROOT / "rom" / "plane.h5", "F1=5"), "must know the displacement"),
    ):
        done = run(*words)
        assert done.returncode == 2 and said in done.stderr and len(done.stderr.splitlines()) == 1
