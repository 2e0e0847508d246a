"""A section's file of Gmsh is read whole, or refused in one line that names file, group and rule."""

from pathlib import Path

import numpy as np
import pytest
from gmsh_files import write, write_mesh
from pydantic import ValidationError

from fingerfem import SceneError, load_scene
from fingerfem.scene.grid_lines import section_mesh
from fingerfem.scene.scene import Scene
from fingerfem.scene.sections import Circle, Column, Wanted

SIDE, WIDTH = 0.010, 0.002
FORMATS = ("2.2", "4.1")
GRID = np.linspace(-SIDE / 2, SIDE / 2, 6)
POINTS = np.stack(np.meshgrid(GRID, GRID), axis=-1).reshape(-1, 2)
AT = np.arange(36).reshape(6, 6)
QUADS = np.stack([AT[:-1, :-1], AT[:-1, 1:], AT[1:, 1:], AT[1:, :-1]], axis=-1).reshape(-1, 4)
CENTRES = POINTS[QUADS].mean(axis=1)
CHANNEL = np.flatnonzero((np.abs(CENTRES - [0.004, 0.0]) < WIDTH / 2).all(axis=1))
RUBBER = np.setdiff1d(np.arange(25), CHANNEL)
GROUPS = {"rubber": QUADS[RUBBER], "channel F1": QUADS[CHANNEL]}
TABLE = {
    "name": "from a file",
    "section": {"file": "section.msh"},
    "geometry": {"segments": [0.05], "plate": 0.001},
    "material": {"law": "neo-hookean", "C1": 1.9e6, "D1": 2.43e-7},
    "tendons": [{"name": "F1", "offset": [0.004, 0.0], "segment": 1, "tension": [0.0, 100.0]}],
    "mesh": {"cells": [20, 1]},
}


def scene(path, **changes) -> Scene:
    return Scene.model_validate(TABLE | {"section": {"file": str(path)}} | changes)


@pytest.mark.parametrize("version", FORMATS)
def test_a_file_s_quadrilaterals_and_channels_are_those_of_the_scene(tmp_path, version):
    one = scene(write(tmp_path / "section.msh", POINTS, GROUPS, version))
    mesh = section_mesh(one.outline, 1)
    assert mesh.area == pytest.approx(SIDE**2, rel=1e-12) and len(mesh.quads) == 25
    assert mesh.column_centroid(0) == pytest.approx([0.004, 0.0], abs=1e-15)
    assert mesh.column_area(0) == pytest.approx(WIDTH**2, rel=1e-12)
    assert (one.geometry.side, one.geometry.shape.top) == pytest.approx((SIDE, SIDE / 2))
    assert one.geometry.shape.second_moment == pytest.approx(SIDE**4 / 12, rel=1e-12)
    assert len(section_mesh(one.outline, 3).quads) == 225


def test_quadrilaterals_may_be_turned_either_way_round(tmp_path):
    turned = {name: own[:, ::-1] for name, own in GROUPS.items()}
    mesh = section_mesh(scene(write(tmp_path / "section.msh", POINTS, turned)).outline, 1)
    assert mesh.scaled_jacobians == pytest.approx(np.ones(25))


def test_a_file_is_found_beside_its_scene_and_is_that_of_its_content(tmp_path):
    write(tmp_path / "section.msh", POINTS, GROUPS)
    text = (
        'name = "x"\n[section]\nfile = "section.msh"\n[geometry]\nsegments = [0.05]\nplate = 0.001\n'
        '[material]\nlaw = "neo-hookean"\nC1 = 1.9e6\nD1 = 2.43e-7\n[[tendons]]\nname = "F1"\noffset = [0.004, 0.0]\n'
        "segment = 1\ntension = [0.0, 100.0]\n[mesh]\ncells = [20, 1]\n"
    )
    (tmp_path / "scene.toml").write_text(text)
    one = load_scene(tmp_path / "scene.toml")
    again = Scene.model_validate(one.model_dump(mode="json"))
    assert again == one and again.fingerprint() == one.fingerprint()
    copy = write(tmp_path / "copy.msh", POINTS, GROUPS)
    assert scene(copy).section.digest == one.section.digest and scene(copy).fingerprint() == scene(copy).fingerprint()
    write(tmp_path / "section.msh", 1.01 * POINTS, GROUPS)
    assert load_scene(tmp_path / "scene.toml").fingerprint() != one.fingerprint()
    with pytest.raises(ValidationError, match="file must be what it was when the scene was written"):
        Scene.model_validate(one.model_dump(mode="json"))
    (tmp_path / "section.msh").unlink()
    with pytest.raises(SceneError, match=r"scene.toml: section.file must be a mesh of Gmsh, got .*No such file"):
        load_scene(tmp_path / "scene.toml")


def test_half_of_a_mirrored_file_is_modelled_and_of_no_other(tmp_path):
    odd = np.linspace(-SIDE / 2, SIDE / 2, 7)
    points = np.stack(np.meshgrid(GRID, odd), axis=-1).reshape(-1, 2)
    at = np.arange(42).reshape(7, 6)
    quads = np.stack([at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]], axis=-1).reshape(-1, 4)
    near = (np.abs(points[quads].mean(axis=1) - [0.004, 0.0]) < [WIDTH / 2, SIDE / 6]).all(axis=1)
    groups = {"rubber": quads[~near], "channel F1": quads[near]}
    whole = scene(write(tmp_path / "a.msh", points, groups))
    assert whole.is_half and section_mesh(whole.outline, 1, True).copies == 2
    assert section_mesh(whole.outline, 1, True).area == pytest.approx(SIDE**2, rel=1e-12)
    path = write(tmp_path / "b.msh", POINTS, GROUPS)
    assert not scene(path).is_half
    with pytest.raises(ValidationError, match="must be parted into mirror images by edges"):
        scene(path, mesh={"cells": [20, 1], "symmetry": True})


def test_tendons_that_share_a_channel_share_its_group_and_straight_ones_have_holes(tmp_path):
    second = {"name": "F2", "offset": [0.004, 0.0], "segment": 2, "tension": [0.0, 10.0]}
    both = {"tendons": [*TABLE["tendons"], second], "geometry": {"segments": [0.05, 0.05], "plate": 0.001}}
    one = scene(write(tmp_path / "section.msh", POINTS, GROUPS), **both)
    assert [column.tag for column in one.outline.columns] == [0, 0]
    straight = {"tendons": [TABLE["tendons"][0] | {"path": "straight"}]}
    with pytest.raises(ValidationError, match="must have a physical group 'hole F1', got 'rubber', 'channel F1'"):
        scene(tmp_path / "section.msh", **straight)
    holes = {"rubber": GROUPS["rubber"], "hole F1": GROUPS["channel F1"]}
    assert section_mesh(scene(write(tmp_path / "b.msh", POINTS, holes), **straight).outline, 1).column_area(0) > 0


def moved(node: int, by: tuple[float, ...]) -> np.ndarray:
    points = np.column_stack([np.zeros(36), POINTS])
    points[node] += by
    return points


LONE = {"rubber": np.concatenate([GROUPS["rubber"], [[36, 37, 38, 39]]]), "channel F1": GROUPS["channel F1"]}
FAR = np.concatenate([POINTS, np.array([[0.02, 0.0], [0.03, 0.0], [0.03, 0.01], [0.02, 0.01]])])
REFUSED = {
    "no rubber": (POINTS, {"channel F1": QUADS}, "must have a physical group 'rubber', got 'channel F1'"),
    "no channel": (POINTS, {"rubber": QUADS}, "must have a physical group 'channel F1', got 'rubber'"),
    "unknown group": (
        POINTS,
        {"rubber": QUADS[RUBBER[1:]], "channel F1": QUADS[CHANNEL], "bone": QUADS[RUBBER[:1]]},
        "must have no physical groups but 'rubber', 'channel F1', got 'bone'",
    ),
    "double element": (
        POINTS,
        {"rubber": QUADS, "channel F1": QUADS[CHANNEL]},
        "must have every element once, in one group, got one of 'rubber' 2 times, nodes ",
    ),
    "inverted element": (
        moved(14, (0.0, 0.003, 0.003)),
        GROUPS,
        r"group 'rubber', quadrilateral \d+: must have a sine of at least 0.2 at every corner, got -1",
    ),
    "poor element": (
        moved(14, (0.0, 0.0009, 0.0009)),
        GROUPS,
        r"group 'rubber', quadrilateral \d+: must have a sine of at least 0.2 at every corner, got 0\.",
    ),
    "triangles": (
        POINTS,
        {"rubber": QUADS[RUBBER[1:]], "channel F1": QUADS[CHANNEL], "corner": QUADS[:1, :3]},
        "must have quadrilaterals of four nodes alone .*, got 1 of triangle",
    ),
    "off the plane": (moved(3, (1e-4, 0.0, 0.0)), GROUPS, r"must lie in the plane x = 0, .* got a node at \[0.0001"),
    "in millimetres": (1e3 * POINTS, GROUPS, r"must be between 1e-6 and 1 m large, got 10 m \(a length in mm\?\)"),
    "two pieces": (FAR, LONE, "must be one piece whose elements share edges, got 2 pieces"),
    "offset outside": (
        POINTS,
        {"rubber": np.delete(QUADS, 0, axis=0), "channel F1": QUADS[:1]},
        r"group 'channel F1' must contain its tendon's offset, got \[0.004, 0.0\]",
    ),
}


@pytest.mark.parametrize("version", FORMATS)
@pytest.mark.parametrize("case", REFUSED)
def test_what_a_file_may_not_have_is_refused_with_its_name(tmp_path, case, version):
    points, groups, rule = REFUSED[case]
    path = write(tmp_path / "broken.msh", points, groups, version)
    with pytest.raises(ValidationError, match=rule) as refused:
        scene(path)
    assert str(path) in str(refused.value)


def test_two_nodes_at_one_point_and_elements_in_no_named_group_are_refused(tmp_path):
    torn = GROUPS["rubber"].copy()
    row = int(np.flatnonzero((torn == 14).any(axis=1))[0])
    torn[row][torn[row] == 14] = 36
    path = write(tmp_path / "torn.msh", np.concatenate([POINTS, POINTS[14:15]]), GROUPS | {"rubber": torn})
    with pytest.raises(ValidationError, match=r"must have one node at a point \(in Gmsh: Coherence Mesh\), got two at"):
        scene(path)
    path = write(tmp_path / "lines.msh", POINTS, GROUPS, names={"border": 1})
    with pytest.raises(ValidationError, match="must have physical groups of surfaces alone, got 'border'"):
        scene(path)
    path = write(tmp_path / "nameless.msh", POINTS, GROUPS, "2.2")
    path.write_text(
        path.read_text().replace("$PhysicalNames\n2\n", "$PhysicalNames\n1\n").replace('2 2 "channel F1"\n', "")
    )
    with pytest.raises(ValidationError, match="must have names for all physical groups"):
        scene(path)
    path.write_text("no mesh")
    with pytest.raises(ValidationError, match="must be a mesh of Gmsh, format"):
        scene(path)


def test_a_channel_s_width_is_left_to_the_file(tmp_path):
    path = write(tmp_path / "section.msh", POINTS, GROUPS)
    with pytest.raises(ValidationError, match=r"channel must be left out where section.file has the channels"):
        scene(path, geometry=TABLE["geometry"] | {"channel": 0.002})


@pytest.mark.parametrize("version", FORMATS)
def test_a_circle_s_mesh_comes_back_from_a_file(tmp_path, version):
    columns = [Column(name="F1", path="channel", offset=np.array([0.004, 0.0]), tag=0)]
    circle = Circle(shape="circle", diameter=0.012)
    mesh = circle.mesh(Wanted(columns=columns, width=WIDTH, across=6))
    one = scene(write_mesh(tmp_path / "circle.msh", mesh, {0: "channel F1"}, version))
    read = section_mesh(one.outline, 1)
    assert read.area == pytest.approx(mesh.area, rel=1e-14) and len(read.quads) == len(mesh.quads)
    assert read.column_area(0) == pytest.approx(mesh.column_area(0), rel=1e-14)
    assert np.allclose(np.sort(read.scaled_jacobians), np.sort(mesh.scaled_jacobians), atol=1e-12)


def test_a_file_that_gmsh_wrote_is_an_ellipse_with_a_square_channel():
    """Gmsh 4.15, `gmsh -2 ellipse.geo`: 16 x 12 mm, 85 quadrilaterals; their straight sides lie within the ellipse."""
    one = scene(Path(__file__).with_name("ellipse.msh"))
    mesh = section_mesh(one.outline, 1)
    y, z = mesh.points[np.unique(mesh.border)].T
    assert (y / 0.008) ** 2 + (z / 0.006) ** 2 == pytest.approx(np.ones(len(y)), rel=1e-9)
    assert 0.98 < mesh.area / (np.pi * 0.008 * 0.006) < 1
    assert mesh.column_area(0) == pytest.approx(WIDTH**2, rel=1e-9)
    assert mesh.column_centroid(0) == pytest.approx([0.004, 0.0], abs=1e-12)
    assert one.geometry.shape.second_moment == pytest.approx(np.pi / 4 * 0.008 * 0.006**3, rel=0.03)


def test_the_reference_shows_what_that_file_was_made_of():
    page = Path(__file__).resolve().parents[4] / "docs" / "reference" / "scene.md"
    assert f"```\n{Path(__file__).with_name('ellipse.geo').read_text()}```" in page.read_text()
