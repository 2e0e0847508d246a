"""Materials that a scene cannot have are refused by one line; cells have the material of their region."""

import re
from typing import Any

import numpy as np
import pytest
from gmsh_files import write_mesh
from pydantic import ValidationError

from fingerfem.discretisation.mesh import build_mesh
from fingerfem.discretisation.regions import materials
from fingerfem.scene.grid_lines import section_mesh
from fingerfem.scene.scene import Scene
from fingerfem.scene.sections import PlaneMesh
from fingerfem.scene.toml_file import one_line
from rom.rod.scene.scene_of_rod import of_tables

STIFF = {"law": "neo-hookean", "E": 5e7, "nu": 0.3}
LAYER = {"name": "layer", "region": "rectangle", "centre": [-0.0045, 0.0], "size": [0.001, 0.01], "material": STIFF}
JOINT = {"name": "joint", "region": "section", "x": [0.02, 0.03], "material": STIFF}
TABLE: dict[str, Any] = {
    "name": "finger",
    "geometry": {"side": 0.010, "segments": [0.050], "plate": 0.001},
    "material": {"law": "neo-hookean", "C1": 1.9e6, "D1": 2.43e-7},
    "tendons": [{"name": "F1", "offset": [0.004, 0.0], "segment": 1, "tension": [0.0, 50.0]}],
    "mesh": {"cells": [10, 7]},
}
PLANE = {"distance": [0.001, 0.031], "method": "nitsche"}
CIRCLE = {"section": {"shape": "circle", "diameter": 0.012}, "geometry": {"segments": [0.05], "plate": 0.001}}


@pytest.mark.parametrize(
    ("changes", "rule"),
    [
        ({"materials": [LAYER | {"name": "rubber"}]}, "materials.0.name must be unique and not 'rubber'"),
        ({"materials": [JOINT, JOINT | {"x": [0.04, 0.045]}]}, "materials.0.name must be unique .*, got joint"),
        (
            {"materials": [LAYER | {"material": {"law": "steel"}}]},
            "materials.0.material.law must be 'mooney-rivlin' or .*, got 'steel'",
        ),
        ({"materials": [LAYER | {"material": {"C1": 1e6}}]}, "materials.0.material.law is required and missing"),
        (
            {"materials": [LAYER | {"material": STIFF | {"nu": 0.6}}]},
            "materials.0.material.nu must be from 0 to",
        ),
        ({"materials": [LAYER | {"region": "group"}]}, "centre must be left out where region is 'group'"),
        ({"materials": [JOINT | {"region": "group"}]}, "must be 'section' or 'rectangle' with a square section"),
        ({"materials": [LAYER]} | CIRCLE, "materials.0.region must be 'section' with a circle section"),
        ({"materials": [LAYER | {"size": [0.002, 0.01]}]}, "must end within the section, got 0.0005 m beyond it"),
        ({"materials": [JOINT | {"x": [0.03, 0.02]}]}, "materials.0.x must be .lowest, highest."),
        ({"materials": [JOINT | {"x": [0.03, 0.06]}]}, "end on the finger, at most at 0.05 m"),
        ({"materials": [JOINT | {"x": [0.03, 0.03001]}]}, "at least a hundredth of the side"),
        ({"materials": [LAYER, JOINT]}, "materials.1.region must have no cells of another material.* of layer"),
        ({"materials": [LAYER, LAYER | {"name": "more", "centre": [-0.004, 0.0]}]}, "got some of layer"),
        ({"materials": [JOINT], "obstacle": PLANE}, "method must be penalty with several materials"),
        ({"materials": [JOINT], "preset": "draft", "mesh": None}, r"preset must be left out with \[\[materials\]\]"),
        (
            {"materials": [LAYER | {"centre": [-0.0045, 0.001], "size": [0.001, 0.002]}], "mesh": {"cells": [10, 11]}}
            | {"mesh": {"cells": [10, 11], "symmetry": True}},
            "mesh.symmetry must be false where a tendon, chamber or material is off the plane z = 0",
        ),
    ],
)
def test_a_material_that_a_scene_cannot_have_is_refused(changes, rule):
    table = {key: value for key, value in (TABLE | changes).items() if value is not None}
    with pytest.raises(ValidationError) as refusal:
        Scene.model_validate(table)
    assert re.search(rule, one_line(refusal.value)), one_line(refusal.value)


def test_a_scene_with_other_materials_may_have_a_load_and_a_coarse_mesh():
    scene = Scene.model_validate(
        TABLE | {"materials": [LAYER | {"x": [0.0, 0.05]}], "load": {"force": 5.0}, "coarse": {"cells": [9, 7]}}
    )
    assert scene.on_coarse_mesh().materials == scene.materials
    assert of_tables(scene.model_dump(mode="json"))["materials"][0]["name"] == "layer"


def test_a_scene_without_other_materials_is_as_before_and_others_count():
    plain = Scene.model_validate(TABLE)
    assert "materials" not in plain.model_dump()
    one, other = (
        Scene.model_validate(TABLE | {"materials": [JOINT | {"material": STIFF | {"E": E}}]}) for E in (5e7, 6e7)
    )
    assert len({plain.fingerprint(), one.fingerprint(), other.fingerprint()}) == 3
    assert Scene.model_validate(one.model_dump(mode="json")) == one


@pytest.mark.parametrize(
    ("own", "volume"),
    [
        (LAYER, 0.001 * 0.01 * 0.049),
        (LAYER | {"x": [0.01, 0.02]}, 0.001 * 0.01 * 0.01),
        (JOINT, 1e-4 * 0.01),
        (LAYER | {"centre": [0.004, 0.0], "size": [0.002, 0.002]}, 0.002**2 * 0.049),  # a tendon's channel
    ],
)
def test_a_material_has_the_volume_of_its_region_and_leaves_channels_and_plates(own, volume):
    import dolfinx
    from mpi4py import MPI

    scene = Scene.model_validate(TABLE | {"materials": [own], "mesh": {"cells": [10, 7], "symmetry": False}})
    mesh, plain = (build_mesh(one, MPI.COMM_SELF) for one in (scene, scene.model_copy(update={"materials": []})))
    found = materials(mesh.cells.values)
    corners = mesh.mesh.geometry.x[mesh.mesh.geometry.dofmap]
    volumes = np.prod(corners[:, 7] - corners[:, 0], axis=1)
    assert volumes[found == 1].sum() == pytest.approx(volume, rel=1e-9)
    assert volumes[found == -1].sum() == pytest.approx(1e-4 * 0.001, rel=1e-9)
    assert isinstance(mesh.cells, dolfinx.mesh.MeshTags)
    assert mesh.pulled(scene, 0)[1] == pytest.approx(plain.pulled(scene, 0)[1], rel=1e-12)


@pytest.fixture
def halves(tmp_path):
    """A file of a rectangle: its lower half is of another material; a channel is in the upper one."""

    def written(name: str) -> dict:
        y, z = np.linspace(-0.006, 0.006, 7), np.linspace(-0.005, 0.005, 6)
        points = np.stack(np.meshgrid(y, z), axis=-1).reshape(-1, 2)
        at = np.arange(len(points)).reshape(len(z), len(y))
        quads = np.stack([at[:-1, :-1], at[:-1, 1:], at[1:, :-1], at[1:, 1:]], axis=-1).reshape(-1, 4)
        middle = points[quads].mean(axis=1)
        tags = np.where(middle[:, 0] < 0, 7, -1)
        tags[(abs(middle[:, 0] - 0.003) < 1e-9) & (abs(middle[:, 1]) < 1e-9)] = 0
        mesh = PlaneMesh(points=points, quads=quads, tags=tags)
        file = write_mesh(tmp_path / "section.msh", mesh, {0: "channel F1", 7: name})
        tendon = TABLE["tendons"][0] | {"offset": [0.003, 0.0]}
        return TABLE | {
            "section": {"file": str(file)},
            "geometry": {"segments": [0.05], "plate": 0.001},
            "tendons": [tendon],
            "mesh": {"cells": [10, 1]},
        }

    return written


def test_a_group_of_a_file_is_a_material(halves):
    scene = Scene.model_validate(halves("material core") | {"materials": [JOINT | {"name": "core", "region": "group"}]})
    mesh, inlay = section_mesh(scene.outline, 2), scene.outline.inlays[0]
    assert mesh.areas[mesh.tags == inlay.tag].sum() == pytest.approx(6e-5)
    assert mesh.column_area(0) == pytest.approx(4e-6) and mesh.area == pytest.approx(1.2e-4)


def test_a_group_has_the_measures_of_its_region(halves):
    scene = Scene.model_validate(
        halves("material core") | {"materials": [{"name": "core", "region": "group", "material": STIFF}]}
    )
    measured = scene.model_dump()["section"]["measures"]["materials"]["core"]
    assert measured["area"] == pytest.approx(6e-5) and measured["centroid"] == pytest.approx([-0.003, 0.0])
    assert measured["mean_squares"] == pytest.approx([0.006**2 / 3, 0.01**2 / 12])


@pytest.mark.parametrize(
    ("name", "own", "rule"),
    [
        ("material core", [], "section.file .*section.msh: must have no physical groups but .*, got 'material core'"),
        ("material core", ["shell"], "section.file .*: must have a physical group 'material shell'"),
        ("core", ["core"], "section.file .*: must have a physical group 'material core'"),
    ],
)
def test_a_group_and_a_material_that_lack_each_other_are_refused_by_group_and_file(halves, name, own, rule):
    listed = [{"name": one, "region": "group", "material": STIFF} for one in own]
    with pytest.raises(ValidationError, match=rule):
        Scene.model_validate(halves(name) | {"materials": listed})
