"""Elements of any section: trained on few states of a coarse mesh, they answer as the full-order model does there."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from farm import run
from gmsh_files import write_mesh
from mpi4py import MPI

from fingerfem import SceneError
from fingerfem.scene.grid_lines import section_mesh
from fingerfem.scene.scene import Scene
from fingerfem.snapshots.design import HeldOut, describe
from fingerfem.snapshots.job import Job, Request
from fingerfem.snapshots.wrenches import draws, on_plates
from rom.build import train_rod
from rom.dataset.sections import section
from rom.dataset.snapshot_set import SnapshotError, SnapshotSet
from rom.dataset.trainable import MOST_ACTUATORS, check_trainable
from rom.elements.samples.section_states import read_section_states
from rom.elements.samples.symmetry import mirrors
from rom.native import LIBRARY
from rom.rod.pressed_check import check_pressed
from rom.rod.rod import Rod
from studies.sets import as_toml

CIRCLE: dict[str, Any] = {"shape": "circle", "diameter": 0.020}
SECTIONS: dict[str, dict[str, Any]] = {
    "circle": CIRCLE,
    "ring": {"shape": "ring", "diameter": 0.020, "bore": 0.006},
    "rectangle": {"shape": "rectangle", "height": 0.020, "width": 0.014},
    "file": {"file": "section.msh"},
}
MIRRORS = {"circle": 3, "ring": 3, "rectangle": 3, "file": 1}  # with tendons at y and -y; besides the identity
PLACE, FORCE = 6e-4, 0.02  # errors in held-out states, 95th percentile: of the plate's way [-], of contact forces [-]


def table(name: str, folder: Path) -> dict[str, Any]:
    """A finger of 55 mm with two tendons."""
    tendons = [
        {"name": f"F{k}", "offset": [y, 0.0], "segment": 1, "tension": [0.0, 8.0]}
        for k, y in enumerate((0.006, -0.006))
    ]
    whole = {
        "name": name,
        "section": SECTIONS[name],
        "geometry": {"segments": [0.055], "plate": 0.002} | ({} if name == "file" else {"channel": 0.004}),
        "material": {"law": "yeoh", "C1": 1.1e5, "C2": 2e4, "D1": 2e-6},
        "tendons": tendons,
        "load": {"force": 0.8, "friction_angle": 0.6},
        "mesh": {"cells": [14, 1 if name == "file" else 5]},
        "sampling": {"lines": 12, "wrenches": 2},
    }
    if name == "file":
        whole["section"] = {"file": str(sheared(folder / "section.msh"))}
    return whole


def sheared(file: Path) -> Path:
    """A parallelogram: its own image by half a turn alone."""
    scene = Scene.model_validate(table("rectangle", file.parent))
    mesh = section_mesh(scene.outline, 5)
    names = {column.tag: f"channel {column.name}" for column in scene.outline.columns}
    mesh.points[:, 1] += 0.2 * mesh.points[:, 0]
    mesh.points[:, 1] -= mesh.centroid[1]
    return write_mesh(file, mesh, names)


@pytest.fixture(
    scope="module",
    params=["circle", *(pytest.param(one, marks=pytest.mark.long) for one in ("ring", "rectangle", "file"))],
)
def trained(request, tmp_path_factory) -> tuple[str, Path, Rod]:
    folder = tmp_path_factory.mktemp(request.param)
    scene = folder / "scene.toml"
    scene.write_text(as_toml(table(request.param, folder)))
    assert run(1, scene, folder / "set")["failed"] == 0
    return request.param, folder, train_rod(SnapshotSet(folder / "set"), {}, [])


def test_held_out_states_are_answered_that_no_element_has_seen(trained):
    _, folder, finger = trained
    run(1, folder / "scene.toml", folder / "heldout", "--random", "10", "--near", str(folder / "set"))
    held_out = SnapshotSet(folder / "heldout")
    found = check_pressed(finger, held_out)
    way = np.linalg.norm(read_section_states(held_out).plate.places - finger.rest, axis=1)
    assert found["place_m"]["p95"] < PLACE * way.max() and found["contact_force"]["p95"] < FORCE
    assert found["inside"] >= 0.8 and found["states"] == 10


def test_mirrors_are_those_of_mesh_and_tendons_and_the_file_has_the_section(trained):
    name, folder, finger = trained
    states = read_section_states(SnapshotSet(folder / "set"))
    assert len(states.mirrors) == MIRRORS[name] and len(mirrors(states.scene)) == 3
    finger.save(folder / "finger.h5")
    other = Rod.load(folder / "finger.h5")
    assert other.elements.section.area == pytest.approx(finger.elements.section.area)
    assert other.segments[0].area == pytest.approx(section.area(finger.scene))
    again = other.assembled(folder / "scene.toml").place([2.0, 1.0]).centres
    assert again == pytest.approx(finger.place([2.0, 1.0]).centres, abs=1e-9)


def test_wrenches_are_forces_at_points_of_the_plate(tmp_path):
    scene = Scene.model_validate(table("circle", tmp_path) | {"load": {"force": 0.4}})
    wrenches = on_plates(scene, np.random.default_rng(1).random((500, draws(scene))))
    force, moment = wrenches[:, :3], wrenches[:, 3:]
    # A force along the normal of the rim passes the axis, but for those at other points.
    about_axis = np.abs(moment[:, 0]) / np.linalg.norm(force[:, 1:], axis=1)
    assert (about_axis < 1e-12).mean() > 0.55 and about_axis.max() < 0.010 * (1 + 1e-9)


def test_a_section_off_its_axis_is_refused(tmp_path):
    scene = Scene.model_validate(table("rectangle", tmp_path))
    mesh = section_mesh(scene.outline, 5)
    mesh.points[:, 0] += 0.0005
    names = {column.tag: f"channel {column.name}" for column in scene.outline.columns}
    whole = table("file", tmp_path) | {"section": {"file": str(write_mesh(tmp_path / "off.msh", mesh, names))}}
    with pytest.raises(
        SceneError, match=r"section.file must give a centroid within 2e-06 m of the axis, .* got y = 0.0005"
    ):
        describe(Scene.model_validate(whole), {})


SOFT = {"law": "yeoh", "C1": 2.2e5, "C2": 4e4, "D1": 1e-6}


@pytest.mark.parametrize(
    ("tables", "rule"),
    [
        (
            {"materials": [{"name": "part", "region": "section", "x": [0.02, 0.03], "material": SOFT}]},
            r"materials.part.x must be left out to train elements: .* got \[0.02, 0.03\]; train without",
        ),
        ({"geometry": {"segments": [0.055], "plate": 0.002, "taper": [0.9]}}, r"taper must be left out .* got \[0.9\]"),
        ({"geometry": {"segments": [0.05, 0.05], "plate": 0.002}}, "segments must be one to train elements, got 2"),
        ({"sampling": {"lines": 3}}, "lines with an answer must be at least 4 to train elements, got 3"),
    ],
)
def test_a_finger_without_elements_is_refused_before_its_states_are_solved(tmp_path, tables, rule):
    """Held-out states of it are solved: they compare a finger that `rom assemble` made."""
    scene = Scene.model_validate(table("circle", tmp_path) | tables)
    with pytest.raises(SnapshotError, match=rule):
        Job(request=Request(scene=scene, folder=tmp_path / "set"), world=MPI.COMM_SELF)
    assert not (tmp_path / "set").exists()
    assert len(describe(scene, {}, HeldOut(count=2)).random) == 2


def test_a_finger_of_more_actuators_than_a_rod_may_have_is_refused(tmp_path):
    scene = table("circle", tmp_path)
    assert MOST_ACTUATORS == LIBRARY.constants.FINGERFEM_MOST_TENSIONS
    with pytest.raises(SnapshotError, match="tendons and chambers must be at most 8 to train elements, got 9"):
        check_trainable(scene | {"tendons": 3 * scene["tendons"], "chambers": 3 * [{}]})


@pytest.mark.long
def test_states_of_a_coarse_round_mesh_are_where_those_of_a_fine_one_begin(tmp_path):
    """Fields go from mesh to mesh by triangles of a section's nodes; the states are those from rest."""
    sampling = {"sampling": {"lines": 4, "wrenches": 1}, "coarse": {"cells": [12, 4]}}
    scene = tmp_path / "scene.toml"
    scene.write_text(as_toml(table("circle", tmp_path) | sampling))
    run(1, scene, tmp_path / "coarse", "--coarse")
    run(1, scene, tmp_path / "rest")
    run(1, scene, tmp_path / "near", "--near", str(tmp_path / "coarse"))
    near, rest = SnapshotSet(tmp_path / "near"), SnapshotSet(tmp_path / "rest")
    assert not near.failures and near.iterations < rest.iterations
    assert near.answered("section_place") == pytest.approx(rest.answered("section_place"), abs=1e-9)
