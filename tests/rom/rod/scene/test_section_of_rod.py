"""Sections of scenes for rods: read, compared to that of the elements, refused with both values."""

import math

import numpy as np
import pytest

from rom.dataset.sections.section import area, channel_width, extent, mean_squares, outline, top
from rom.files.checked_file import ModelError
from rom.rod.scene.scene_of_rod import of_tables, read_scene, rescaled, similarity
from rom.rod.scene.section_of_rod import rescaled_section

GEOMETRY = {"segments": [0.06], "plate": 0.002, "channel": 0.003}  # [m]
MATERIAL = {"law": "yeoh", "C1": 1e5, "C2": 2e4, "D1": 4e-7}
CIRCLE = {"shape": "circle", "diameter": 0.02}
RING = {"shape": "ring", "diameter": 0.02, "bore": 0.006}
RECTANGLE = {"shape": "rectangle", "height": 0.02, "width": 0.03}


def scene(section: dict, size: float = 1.0) -> dict:
    """A scene whose lengths, but for the section's, are scaled."""
    tendon = {"name": "F", "offset": [0.007 * size, 0.0], "segment": 1, "tension": [0.0, 10.0 * size**2]}
    geometry = {"segments": [0.06 * size], "plate": 0.002 * size, "channel": 0.003 * size}
    return {"geometry": geometry, "section": section, "material": MATERIAL, "tendons": [tendon]}


def of(section: dict, size: float = 1.0) -> dict:
    return of_tables(scene(section, size))


@pytest.mark.parametrize("section", [CIRCLE, RING, RECTANGLE])
def test_a_section_of_equal_ratios_is_a_matter_of_size(section):
    larger = {name: 3 * value if name != "shape" else value for name, value in section.items()}
    found = similarity(of(section), of(larger, 3.0))
    assert found.size == pytest.approx(3.0) and found.modulus == 1.0 and found.tendons == [0]


@pytest.mark.parametrize(
    ("section", "rule"),
    [
        (CIRCLE, "section.shape must be ring, as the elements were trained with, got circle"),
        (RING | {"bore": 0.007}, "section.bore over section.diameter must be 0.3, as .* got 0.35"),
        ({"shape": "square", "side": 0.02}, "section.shape must be ring, .* got square"),
    ],
)
def test_another_section_is_refused_with_both_values(section, rule):
    with pytest.raises(ModelError, match=rule):
        similarity(of(RING), of(section))


@pytest.mark.parametrize(
    ("changes", "rule"),
    [
        ({"section": {"shape": "oval"}}, "section.shape must be one of square, .* got 'oval'"),
        ({"section": {"shape": "circle"}}, "section.diameter must be finite and above 0 m, got None"),
        ({"section": CIRCLE | {"bore": 0.01}}, "section must have the keys diameter, shape, got bore"),
        ({"section": RING | {"bore": 0.02}}, "section.bore must be below the diameter, 0.02 m, got 0.02"),
        ({"section": [1.0]}, r"section must be a table \[section\], got \[1.0\]"),
        ({"geometry": GEOMETRY | {"side": 0.02}}, "geometry.side must be left out where .* got 0.02"),
    ],
)
def test_a_table_that_is_no_section_is_refused(changes, rule):
    with pytest.raises(ModelError, match=rule):
        of_tables(scene(CIRCLE) | changes)


def test_a_square_is_geometry_side():
    for square in ({"shape": "square", "side": 0.02}, {"shape": "rectangle", "height": 0.02, "width": 0.02}):
        found = of(square)
        assert found["geometry"]["side"] == 0.02 and "section" not in found


def test_measures_are_closed_forms():
    assert area(of(RING)) == pytest.approx(math.pi / 4 * (0.02**2 - 0.006**2))
    assert area(of(RECTANGLE)) == pytest.approx(6e-4) and extent(of(RECTANGLE)) == pytest.approx(0.03)
    assert outline(of(RECTANGLE)).box.tolist() == [0.01, 0.015] and top(of(CIRCLE)) == pytest.approx(0.01)
    without = {name: value for name, value in GEOMETRY.items() if name != "channel"}
    assert mean_squares(of(RECTANGLE)) == pytest.approx([0.02**2 / 12, 0.03**2 / 12])
    assert mean_squares(of(RING)) == pytest.approx(np.full(2, (0.02**4 - 0.006**4) / 16 / (0.02**2 - 0.006**2)))
    assert channel_width({"geometry": without, "section": RING}) == pytest.approx(0.0035)
    assert channel_width({"geometry": without, "section": RECTANGLE}) == pytest.approx(0.004)


def test_a_file_is_known_by_its_content_and_brings_what_was_measured_of_it(tmp_path):
    text = '[geometry]\nsegments = [0.06]\nplate = 0.002\n[section]\nfile = "section.msh"\n'
    text += "[material]\nC1 = 1e5\nD1 = 4e-7\n"
    text += '[[tendons]]\nname = "F"\noffset = [0.0, 0.0]\nsegment = 1\ntension = [0.0, 10.0]\n'
    (tmp_path / "scene.toml").write_text(text)
    with pytest.raises(ModelError, match=r"section.file must be a mesh of Gmsh, got .*section.msh: No such file"):
        read_scene(tmp_path / "scene.toml")
    (tmp_path / "section.msh").write_text("a mesh")
    own = read_scene(tmp_path / "scene.toml")
    hull = (0.01 * np.array([[-1, -1], [1, -1], [0, 2]])).tolist()
    trained = own | {"section": own["section"] | {"measures": {"area": 3e-4, "hull": hull}}}
    assert extent(trained) == pytest.approx(0.04)
    assert similarity(trained, own | {"section": trained["section"]}).size == 1.0
    (tmp_path / "section.msh").write_text("another mesh")
    with pytest.raises(ModelError, match=r"section.file must have the content that the elements .* digest .* got .*"):
        similarity(trained, read_scene(tmp_path / "scene.toml"))


@pytest.mark.parametrize("section", [CIRCLE, RING, RECTANGLE])
def test_a_rescaled_scene_is_as_many_times_as_large_and_stiff(section):
    trained = of(section)
    found = similarity(trained, rescaled(trained, 0.8, 1.1))
    assert (found.size, found.modulus) == pytest.approx((1.1, 0.8))


def test_a_section_of_a_file_is_not_rescaled():
    with pytest.raises(ModelError, match=r"size must be 1 for a section of a file, got 1\.1"):
        rescaled_section({"shape": "file", "file": "own.msh"}, 1.1)
