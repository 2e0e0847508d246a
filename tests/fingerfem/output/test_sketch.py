"""The drawing of a scene at rest says every measure of it, and nothing that is not there."""

import subprocess
import sys

import pytest
from farm import ROOT
from matplotlib.collections import PolyCollection
from matplotlib.text import Text
from PIL import Image

from fingerfem import load_scene
from fingerfem.output.sketch import sketch, write_sketch
from fingerfem.scene.scene import Scene

SCENES = ("one_segment", "two_segments", "four_tendons", "draft", "free", "demo/fine")


def drawn(name: str):
    return sketch(load_scene(ROOT / "scenes" / f"{name}.toml"))


def words(figure) -> str:
    """All that is written in a drawing."""
    return "\n".join(text.get_text() for text in figure.findobj(Text))


@pytest.mark.parametrize("name", SCENES)
def test_axes_side_segments_and_every_tendon_with_its_offset_and_plate_are_named(name):
    scene = load_scene(ROOT / "scenes" / f"{name}.toml")
    said = words(sketch(scene))
    for word in ("x [mm]", "y [mm]", "z [mm]", "\nx\n", "\ny\n", "\nz\n", "clamp", "side 10 mm", "plate, 1 mm"):
        assert word in said, word
    assert said.count(": 50 mm") == len(scene.geometry.segments)
    for tendon in scene.tendons:
        y, z = (f"{1e3 * offset:g}" for offset in tendon.offset)
        plate = f"plate {tendon.segment}" if len(scene.geometry.segments) > 1 else "the plate"
        assert f"{tendon.name}: y = {y}, z = {z} mm, ends in {plate}, 0 to {tendon.tension[1]:g} N" in said


def test_a_plane_is_drawn_with_its_range_of_d_and_the_pad():
    said = words(drawn("one_segment"))
    assert "rigid plane" in said and "d = 1 to 31 mm" in said and "pad fingertip: x = 49 to 50 mm" in said
    assert "wrench" not in said


def test_without_an_obstacle_there_is_neither_plane_nor_pad_nor_d():
    said = words(drawn("free"))
    assert not any(word in said for word in ("plane", "pad", "d = ", "wrench"))


def test_of_a_scene_with_a_load_the_wrench_on_the_plate_is_drawn():
    said = words(drawn("demo/fine"))
    assert "wrench w: force up to 15 N" in said and "plane" not in said


def test_tendons_end_in_the_plates_that_they_pull_on():
    """Rings mark where: those of the short ones in the middle plate."""
    side = drawn("two_segments").axes[0]
    ends = sorted(float(line.get_xdata()[0]) for line in side.lines if line.get_marker() == "o" and line.get_xdata()[0])
    assert ends == pytest.approx([49.5, 99.5])


@pytest.mark.parametrize("name", SCENES)
def test_no_two_words_of_the_side_view_lie_on_each_other(name):
    figure = drawn(name)
    figure.draw_without_rendering()
    boxes = [text.get_window_extent() for text in figure.axes[0].texts if text.get_text()]
    assert len(boxes) > 5
    assert not [1 for k, box in enumerate(boxes) for other in boxes[:k] if box.overlaps(other)]


@pytest.mark.parametrize("name", SCENES)
def test_every_axis_has_three_numbers_at_least(name):
    figure = drawn(name)
    figure.draw_without_rendering()
    for axes in figure.axes[:2]:
        for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
            assert sum(low <= tick <= high for tick in axis.get_majorticklocs()) >= 3


@pytest.mark.parametrize(
    "shape",
    [
        {"shape": "sphere", "centre": [0.045, 0.015, 0.0], "radius": 0.01},
        {"shape": "plane", "centre": [0.0, 0.01, 0.0], "normal": [0.5, -1.0, 0.0]},
    ],
)
def test_another_obstacle_is_drawn_by_its_cut_with_its_range(table, shape):
    table["obstacle"] = {"method": "penalty", "distance": [0.003, 0.02]} | shape
    figure = sketch(Scene.model_validate(table))
    assert f"{shape['shape']}: d = 3 to 20 mm" in words(figure) and figure.axes[0].collections


def test_a_tendon_without_a_channel_is_dashed(table):
    table["tendons"][0]["path"] = "straight"
    side = sketch(Scene.model_validate(table)).axes[0]
    assert "--" in [line.get_linestyle() for line in side.lines]


def test_the_command_writes_the_picture_and_refuses_what_it_cannot_write(tmp_path):
    command = [sys.executable, "-m", "fingerfem", "sketch", "scenes/draft.toml"]
    subprocess.run([*command, str(tmp_path / "new" / "draft.png")], cwd=ROOT, check=True)
    with Image.open(tmp_path / "new" / "draft.png") as picture:
        assert picture.width > 900 and len(picture.convert("RGB").getcolors(1 << 20)) > 20
    with pytest.raises(ValueError, match="picture must end in one of"):
        write_sketch(load_scene(ROOT / "scenes" / "draft.toml"), tmp_path / "draft.doc")


@pytest.mark.parametrize(
    ("section", "measures"),
    [
        ({"shape": "circle", "diameter": 0.02}, "diameter 20 mm"),
        ({"shape": "ring", "diameter": 0.02, "bore": 0.006}, "diameter 20 mm,\nbore 6 mm"),
    ],
)
def test_a_section_is_drawn_by_its_mesh_and_measures(section, measures):
    scene = load_scene(ROOT / "scenes" / "round.toml")
    figure = sketch(Scene.model_validate(scene.model_dump(mode="json", exclude_unset=True) | {"section": section}))
    said = words(figure)
    assert measures in said and "coloured cells: channels, 3 mm wide" in said
    for name, y, z in (("up", 7, 0), ("right", 0, 7), ("down", -7, 0), ("left", 0, -7)):
        assert f"{name}: y = {y}, z = {z} mm" in said
    cells, *channels = (one for one in figure.axes[1].collections if isinstance(one, PolyCollection))
    assert len(channels) == 4 and len(cells.get_paths()) > 4 * len(channels[0].get_paths())
