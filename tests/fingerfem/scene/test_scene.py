"""A scene is what it says, or one line says what is wrong."""

from pathlib import Path

import pytest
from terminal import ran

from fingerfem import SceneError, load_scene

ROOT = Path(__file__).resolve().parents[3]
DRAFT = (ROOT / "scenes" / "draft.toml").read_text()

BROKEN = {
    "side in mm": ("side = 0.010", "side = 10.0", ["geometry.side", "at most 1 m", "10.0"]),
    "length as text": ("plate = 0.001", 'plate = "1 mm"', ["geometry.plate", "number in m", "'1 mm'"]),
    "negative stiffness": ("C1 = 1.9e6", "C1 = -1.9e6", ["material.C1", "at least 100 Pa", "-1900000.0"]),
    "unknown law": ('law = "neo-hookean"', 'law = "jelly"', ["material.law", "neo-hookean", "'jelly'"]),
    "unknown key": ("plate = 0.001", "plate = 0.001\nplat = 1", ["geometry.plat", "known key", "1"]),
    "misspelt key": ("side = 0.010", "sied = 0.010", ["geometry.sied", "known key (did you mean side?)", "0.01"]),
    "unknown table": ("[mesh]", "[colour]\nred = 1\n[mesh]", ["colour", "known key, got a table"]),
    "misspelt table": ("[mesh]", "[mehs]", ["mehs", "did you mean mesh?"]),
    "no list": ("segments = [0.050]", "segments = 0.050", ["geometry.segments must be a list, got 0.05"]),
    "half an offset": ("offset = [0.004, 0.0]", "offset = [0.004]", ["offset must have at least 2 entries"]),
    "missing value": ("C1 = 1.9e6", "", ["material.C1", "required"]),
    "missing table": ("[mesh]", "[obstacle.x]", ["obstacle.x", "known key"]),
    "plate longer than segment": ("plate = 0.001", "plate = 0.06", ["geometry.plate", "shorter", "0.06"]),
    "not a number": ("side = 0.010", "side = nan", ["geometry.side", "finite", "nan"]),
    "tendon outside": ("offset = [0.004, 0.0]", "offset = [0.006, 0.0]", ["tendons.0.offset", "inside", "0.006"]),
    "tendon without plate": ("segment = 1\ntension", "segment = 2\ntension", ["tendons.1.segment", "at most 1", "2"]),
    "same name twice": ('name = "F2"', 'name = "F1"', ["tendons.0.name", "unique", "F1"]),
    "negative tension": ("tension = [0.0, 100.0]#", "tension = [-1.0, 100.0]#", ["tension", "at least 0 N", "-1.0"]),
    "empty range": (
        "distance = [0.001, 0.031]",
        "distance = [0.031, 0.001]",
        ["obstacle.distance", "lowest < highest"],
    ),
    "plane in the finger": (
        "distance = [0.001, 0.031]",
        "distance = [0.0, 0.03]",
        ["obstacle.distance.0", "above 0 m", "0.0"],
    ),
    "unknown contact": ('method = "penalty"', 'method = "glue"', ["obstacle.method", "penalty", "'glue'"]),
    "no cells": ("cells = [20, 5]", "cells = [20, 0]", ["mesh.cells.1", "at least 1", "0"]),
    "no room for channels": ("cells = [20, 5]", "cells = [20, 4]", ["mesh.cells[1]", "at least 5 cells", "4"]),
    "no room for the plate": ("cells = [20, 5]", "cells = [1, 5]", ["mesh.cells[0]", "at least 2 cells", "1"]),
    "cells that lock": ("cells = [20, 5]", "cells = [8, 5]", ["mesh.cells[0]", "two thirds of the side", "0.007 m"]),
    "cells of order 2 that lock": (
        "cells = [20, 5]       # along the longest segment, across the side\norder = 1",
        "cells = [5, 5]\norder = 2",
        ["mesh.cells[0]", "longer than the side", "0.0123 m"],
    ),
    "half a cell": ("cells = [20, 5]", "cells = [20, 5.5]", ["mesh.cells.1", "whole number", "5.5"]),
    "order 3": ("order = 1", "order = 3", ["mesh.order", "at most 2", "3"]),
    "law without name": ('law = "neo-hookean"', "", ["material.law", "required"]),
    "law of another": ('law = "neo-hookean"', 'law = "mooney-rivlin"', ["material.C1 is not a known key, got"]),
    "overlapping channels": (
        "offset = [0.0, 0.004]",
        "offset = [0.003, 0.001]",
        ["tendons.1.offset", "apart", "0.002 m", "[0.003, 0.001]", "F1"],
    ),
    "one channel to one plate": (
        "offset = [0.0, 0.004]",
        "offset = [0.004, 0.0]",
        ["tendons.1.offset", "another plate", "[0.004, 0.0]", "F1"],
    ),
    "unknown path": (
        "segment = 1 ",
        'path = "loose"\nsegment = 1 ',
        ["tendons.0.path", "'channel' or 'straight'", "'loose'"],
    ),
    "symmetry without": ("order = 1", "order = 1\nsymmetry = true", ["mesh.symmetry", "plane z = 0", "true"]),
    "pad beyond the tip": ("x = [0.049, 0.050]", "x = [0.049, 0.060]", ["obstacle.pad.x", "on the finger", "0.06"]),
    "pad without length": ("x = [0.049, 0.050]", "x = [0.05, 0.05]", ["obstacle.pad.x", "lowest < highest"]),
    "pad too wide": ("x = [0.049, 0.050]", "x = [0.049, 0.05]\nwidth = 0.02", ["obstacle.pad.width", "side", "0.02"]),
    "no pad to speak of": ("x = [0.049, 0.050]", "x = [0.03, 0.03001]", ["obstacle.pad", "hundredth of the side"]),
    "no channel to speak of": (
        "side = 0.010",
        "side = 0.010\nchannel = 5e-5",
        ["channel", "hundredth of the side", "5e-05"],
    ),
    "nitsche without a minimum": (
        'method = "penalty"',
        'method = "nitsche"\nstiffness = 10.0',
        ["obstacle.stiffness", "at least 20", "10"],
    ),
    "name of two words": ('name = "F2"', 'name = "F 2"', ["tendons.1.name must be a letter, then", "'F 2'"]),
    "two powers of one": (
        'law = "neo-hookean"\nC1 = 1.9e6',
        'law = "ogden"\nmu = [1.9e6]\nalpha = [2.0, 4.0]',
        ["material.alpha must have as many numbers as mu (1)", "got 2"],
    ),
    "density in g/cm^3": (
        "[mesh]",
        "[gravity]\ndensity = 1.08\ndirection = [1.0, 0.0, 0.0]\n[mesh]",
        ["gravity.density must be at least 10 kg/m^3", "1.08"],
    ),
    "not TOML": ("[mesh]", "[mesh", ["not a TOML file"]),
}


@pytest.mark.parametrize("case", BROKEN)
def test_a_broken_rule_is_one_line_with_file_field_rule_and_value(case, tmp_path):
    old, new, words = BROKEN[case]
    assert old in DRAFT
    file = tmp_path / "broken.toml"
    file.write_text(DRAFT.replace(old, new) if case != "tendon without plate" else new.join(DRAFT.rsplit(old, 1)))
    with pytest.raises(SceneError) as caught:
        load_scene(file)
    message = str(caught.value)
    assert "\n" not in message
    for word in [str(file), *words]:
        assert word in message


def test_a_scene_that_begins_with_a_byte_order_mark_is_read(tmp_path):
    """As editors on Windows write it, with their ends of lines."""
    plain, marked = tmp_path / "plain.toml", tmp_path / "marked.toml"
    plain.write_text(DRAFT)
    marked.write_bytes(b"\xef\xbb\xbf" + DRAFT.replace("\n", "\r\n").encode())
    assert load_scene(marked) == load_scene(plain)
    marked.write_bytes(DRAFT.encode("utf-16"))
    with pytest.raises(SceneError, match="not a TOML file: 'utf-8' codec"):
        load_scene(marked)


def test_channels_that_almost_touch_are_refused_for_the_slivers_they_would_leave(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text(DRAFT.replace("[20, 5]", "[20, 9]").replace("[0.004, 0.0]", "[0.00399999, 0.0]"))
    with pytest.raises(SceneError, match=r"mesh\.cells\[1\] must not be forced to cells thinner .* got 1e-08 m"):
        load_scene(file)


def test_nitsche_is_refused_for_nearly_incompressible_rubber(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text(DRAFT.replace("D1 = 2.43e-7", "D1 = 1e-9").replace('"penalty"', '"nitsche"'))
    with pytest.raises(SceneError, match=r"obstacle\.method must be penalty where the rubber is nearly incompressible"):
        load_scene(file)


@pytest.mark.parametrize(
    ("scene", "names", "is_half"),
    [
        ("free", ["F1"], True),
        ("two_segments", ["F_s", "F_l", "d"], True),
        ("four_tendons", ["F_s1", "F_s2", "F_l1", "F_l2", "d"], False),
    ],
)
def test_shipped_scenes_model_what_they_name(scene, names, is_half):
    found = load_scene(ROOT / "scenes" / f"{scene}.toml")
    assert [parameter["name"] for parameter in found.parameters] == names
    assert found.is_half is is_half


@pytest.mark.parametrize("scene", ["draft", "one_segment"])
def test_shipped_scenes_list_their_parameters_with_units(scene):
    parameters = load_scene(ROOT / "scenes" / f"{scene}.toml").parameters
    assert [(p["name"], p["unit"], p["lower"], p["upper"]) for p in parameters] == [
        ("F1", "N", 0.0, 100.0),
        ("F2", "N", 0.0, 100.0),
        ("d", "m", 0.001, 0.031),
    ]


def test_the_fingerprint_changes_with_every_number_but_not_with_the_name(tmp_path):
    file = tmp_path / "scene.toml"
    prints = []
    changes = [
        ("C1 = 1.9e6", "C1 = 1.90001e6"),
        ("0.050]", "0.051]"),
        ("[0.0, 100.0]", "[0.0, 99.0]"),
        ("[20, 5]", "[21, 5]"),
    ]
    for old, new in [('"draft"', '"draft"'), ('"draft"', '"other"'), *changes]:
        file.write_text(DRAFT.replace(old, new).replace("x = [0.049, 0.051]", "x = [0.049, 0.050]"))
        prints.append(load_scene(file).fingerprint())
    assert prints[0] == prints[1] and len(set(prints)) == 1 + len(changes)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere.toml"], ["nowhere.toml", "No such file"]),
        (["scenes/draft.toml", "F1=nan"], ["F1", "[0, 100] N", "nan"]),
    ],
)
def test_bad_input_ends_the_command_with_one_line_and_code_2(arguments, words):
    done = ran("fingerfem", "solve", *arguments)
    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.strip().splitlines()) == 1
    for word in words:
        assert word in done.stderr
