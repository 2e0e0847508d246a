"""Chambers that a scene cannot have are refused by one line; scenes without chambers are as before."""

import re
from typing import Any

import numpy as np
import pytest
from gmsh_files import write_mesh
from pydantic import ValidationError

from fingerfem.discretisation.chambers import solid_cells
from fingerfem.scene.grid_lines import lines_along, section_mesh
from fingerfem.scene.loads import read_loads
from fingerfem.scene.scene import Scene, SceneError
from fingerfem.snapshots.design import HeldOut, describe
from rom.files.checked_file import ModelError
from rom.rod.scene.scene_of_rod import of_tables

CHAMBER = {"name": "p1", "region": "rectangle", "centre": [-0.0045, 0.0], "size": [0.005, 0.008], "x": [0.004, 0.054]}
CHAMBER |= {"pressure": [0.0, 2e4]}
BORE = {"name": "p1", "region": "bore", "x": [0.004, 0.054], "pressure": [0.0, 2e4]}
F1 = {"name": "F1", "offset": [0.0085, 0.0], "segment": 1, "tension": [0.0, 20.0]}
TABLE: dict[str, Any] = {
    "name": "finger",
    "geometry": {"side": 0.020, "segments": [0.060], "plate": 0.002, "channel": 0.003},
    "material": {"law": "neo-hookean", "C1": 5e4, "D1": 4e-6},
    "tendons": [F1],
    "chambers": [CHAMBER],
    "mesh": {"cells": [10, 7]},
}
NO_SIDE = {"segments": [0.060], "plate": 0.002}
RING = {
    "section": {"shape": "ring", "diameter": 0.02, "bore": 0.008},
    "geometry": NO_SIDE,
    "tendons": [F1 | {"offset": [0.0075, 0.0]}],
}


def with_chambers(*changes: dict, **others: Any) -> dict:
    return {"chambers": [CHAMBER | change for change in changes]} | others


@pytest.mark.parametrize(
    ("changes", "rule"),
    [
        (with_chambers({"name": "F1"}), "name must be unique and no other parameter's, got F1"),
        (with_chambers({}, {"centre": [0.003, 0.0]}), "name must be unique and no other parameter's, got p1"),
        (with_chambers({"pressure": [-1.0, 2e4]}), "greater than or equal to 0"),
        (
            with_chambers({"pressure": [2e4, 2e4]}),
            "chambers.0.pressure must be .lowest, highest. with lowest < highest",
        ),
        (with_chambers({"x": [0.054, 0.004]}), "chambers.0.x must be .lowest, highest."),
        (with_chambers({"x": [0.004, 0.059]}), r"chambers.0.x must lie in the rubber of one segment, \[0, 0.058\] m"),
        (with_chambers({"x": [0.004, 0.0041]}), "chambers.0.x must be at least a hundredth of the side"),
        (with_chambers({"centre": [-0.0076, 0.0]}), "chambers.0.size must leave a wall of at least a hundredth"),
        (
            with_chambers({"centre": [0.005, 0.0]}),
            "other chamber meets it .* an overlap of .* with F1",
        ),
        (
            with_chambers({"centre": [0.005, 0.0]}, tendons=[F1 | {"path": "straight"}]),
            "other chamber meets it .* an overlap of .* with F1",
        ),
        (
            with_chambers({}, {"name": "p2", "centre": [-0.0046, 0.0]}),
            "an overlap of 0.0049 m with p1",
        ),
        (with_chambers({}, {"name": "p2", "x": [0.0541, 0.058]}), "as far from another chamber of the same region"),
        (with_chambers({"centre": None}), "centre must be given"),
        (with_chambers({"region": "bore"}), "centre must be left out where region is 'bore'"),
        ({"chambers": [BORE]}, "chambers.0.region must be 'rectangle' with a square section, got 'bore'"),
        ({"chambers": [BORE | {"region": "group"}]}, "must be 'rectangle' with a square section, got 'group'"),
        (RING, "chambers.0.region must be 'bore' with a ring section, got 'rectangle'"),
        (
            {
                "section": {"shape": "circle", "diameter": 0.02},
                "geometry": NO_SIDE,
                "tendons": [F1 | {"offset": [0.0, 0.0]}],
            },
            "chambers.0.region must not be given; take a ring, rectangle, square or file with a circle section",
        ),
        (
            with_chambers({"x": [0.021, 0.054]}, load={"force": 1.0}),
            r"chambers.0.x must begin within one side of its segment's clamp, .* \(0, 0.02\] and \[0.038, 0.058\] m",
        ),
        (with_chambers({"x": [0.0, 0.054]}, load={"force": 1.0}), "chambers.0.x must begin within .* not at it"),
        (with_chambers({"x": [0.004, 0.037]}, load={"force": 1.0}), "chambers.0.x must begin within .* got .*0.037"),
        ({"coarse": {"cells": [10, 5]}}, "coarse must be left out of a scene with chambers"),
        ({"preset": "draft", "mesh": None}, r"preset must be left out with \[\[chambers\]\]"),
        (
            with_chambers({"centre": [-0.0045, 0.001]}, mesh={"cells": [10, 11], "symmetry": True}),
            "mesh.symmetry must be false where a tendon, chamber or material is off the plane z = 0",
        ),
    ],
)
def test_a_chamber_that_a_scene_cannot_have_is_refused(changes, rule):
    table = {key: value for key, value in (TABLE | changes).items() if value is not None}
    with pytest.raises(ValidationError, match=rule):
        Scene.model_validate(table)


def test_chambers_of_two_segments_may_not_cross_the_plate_between_them():
    geometry = TABLE["geometry"] | {"segments": [0.030, 0.030]}
    with pytest.raises(
        ValidationError, match=re.escape("one segment, [0, 0.028] or [0.03, 0.058] m, got [0.004, 0.054]")
    ):
        Scene.model_validate(TABLE | {"geometry": geometry})


def test_snapshots_draw_tensions_and_pressures_from_their_ranges():
    scene = Scene.model_validate(TABLE | {"load": {"force": 1.0}, "sampling": {"lines": 12}})
    set_of_it = describe(scene, {})
    drawn = np.array(set_of_it.scattered)
    assert set_of_it.actuators == 2 and drawn.shape == (12, 2)
    assert (drawn.min(axis=0) == 0).all() and drawn.max(axis=0) == pytest.approx([20.0, 2e4], rel=0.1)
    held_out = np.array(describe(scene, {}, HeldOut(count=30)).random)
    assert held_out.shape == (30, 8) and held_out[:, 1].max() > 1e4
    with pytest.raises(SceneError, match=r"tendons must have one on the plane's side .*, or chambers one on the other"):
        flat = [F1 | {"offset": [0.0, 0.0]}]
        high = [CHAMBER | {"centre": [0.0045, 0.0]}]
        describe(
            Scene.model_validate(TABLE | {"tendons": flat, "chambers": high, "obstacle": {"distance": [0.001, 0.02]}}),
            {},
        )


def test_rods_have_straight_rectangular_chambers_alone():
    with pytest.raises(ModelError, match=r"chambers.p1.region must be 'rectangle' in a rod's scene, got 'bore'"):
        of_tables(TABLE | {"chambers": [BORE]})
    with pytest.raises(ModelError, match=r"geometry.taper must be left out with chambers"):
        of_tables(TABLE | {"geometry": TABLE["geometry"] | {"taper": [0.9]}})


def test_pressures_follow_tensions_among_the_parameters():
    scene = Scene.model_validate(TABLE | {"obstacle": {"distance": [0.001, 0.02]}})
    assert [(one["name"], one["unit"]) for one in scene.parameters] == [("F1", "N"), ("p1", "Pa"), ("d", "m")]
    assert read_loads(scene, ["p1=2e4", "d=0.002"]) == {"tensions": [0.0, 2e4], "distance": 0.002}
    with pytest.raises(ValueError, match="NAME one of F1, p1, d, got p2=1"):
        read_loads(scene, ["p2=1"])


def test_a_scene_without_chambers_is_as_before_and_one_with_has_another_fingerprint():
    with_one, without = Scene.model_validate(TABLE), Scene.model_validate(TABLE | {"chambers": []})
    assert "chambers" not in without.model_dump() and with_one.fingerprint() != without.fingerprint()
    assert Scene.model_validate(with_one.model_dump(mode="json")).fingerprint() == with_one.fingerprint()


@pytest.mark.parametrize("changes", [{}, RING | {"chambers": [BORE]}], ids=["square", "ring"])
def test_the_mesh_lacks_the_cells_of_the_chamber_alone(changes):
    scene = Scene.model_validate(TABLE | changes)
    lines, section = lines_along(scene.outline, scene.mesh), section_mesh(scene.outline, 7, scene.is_half)
    assert {0.004, 0.054} <= set(np.round(lines, 12))
    quads, slabs = np.divmod(solid_cells(scene, section, lines), len(lines) - 1)
    volume = section.copies * (section.areas[quads] * np.diff(lines)[slabs]).sum()
    hollow = 0.05 * (0.005 * 0.008 if not changes else np.pi * 0.004**2)
    assert 0.06 * section.area - volume == pytest.approx(hollow, rel=1e-9)


def groups(folder, tags: dict[int, str], **changes: Any) -> dict:
    """The square with groups of a file in place of its chamber."""
    mesh = section_mesh(Scene.model_validate(TABLE | changes).outline, 7)
    file = write_mesh(folder / "section.msh", mesh, tags)
    group = {key: value for key, value in CHAMBER.items() if key not in ("centre", "size")} | {"region": "group"}
    return TABLE | {
        "section": {"file": str(file)},
        "geometry": NO_SIDE,
        "chambers": [group],
        "mesh": {"cells": [10, 1]},
    }


def test_a_file_has_a_group_for_its_chamber_with_rubber_around_it(tmp_path):
    assert Scene.model_validate(groups(tmp_path, {0: "channel F1", -2: "chamber p1"})).is_half
    with pytest.raises(ValidationError, match="must have a physical group 'chamber p1', got 'rubber', 'channel F1'"):
        Scene.model_validate(groups(tmp_path, {0: "channel F1"}))
    at_border = groups(tmp_path, {-2: "channel F1", 0: "chamber p1"})
    with pytest.raises(
        ValidationError, match="must have cells of chamber p1, with rubber all around them, got 1 cells"
    ):
        Scene.model_validate(at_border | {"tendons": [F1 | {"offset": [-0.0045, 0.0]}]})
