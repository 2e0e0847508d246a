"""Loads from words: every name has its place, and what is left out is zero or away."""

import pytest

from fingerfem.scene.loads import read_loads
from fingerfem.scene.scene import Scene


@pytest.fixture
def before_a_plane(table) -> Scene:
    return Scene.model_validate(table)


@pytest.fixture
def pressed(table) -> Scene:
    """Two segments whose plates wrenches press on."""
    table |= {"load": {"force": 3.0}, "sampling": {"lines": 16}}
    del table["obstacle"]
    table["geometry"] |= {"segments": [0.025, 0.025]}
    table["tendons"][1]["segment"] = 2
    return Scene.model_validate(table)


def test_words_in_any_order_are_the_same_loads_and_what_is_left_out_is_nothing(before_a_plane):
    expected = {"tensions": [50.0, 2.5], "distance": 0.01}
    words = ["F1=50", "F2=2.5", "d=1e-2"]
    assert read_loads(before_a_plane, words) == read_loads(before_a_plane, words[::-1]) == expected
    assert read_loads(before_a_plane, []) == {"tensions": [0.0, 0.0], "distance": None}
    assert read_loads(before_a_plane, ["d=0.02"]) == {"tensions": [0.0, 0.0], "distance": 0.02}


def test_every_component_of_a_wrench_goes_to_its_plate_and_place(pressed):
    """A different number for each name: none may be lost or exchanged."""
    names = [one["name"] for one in pressed.parameters]
    assert len(names) == 2 + 2 * 6
    found = read_loads(pressed, [f"{name}={k + 1}" for k, name in enumerate(names)])
    assert found == {"tensions": [1.0, 2.0], "wrenches": [[3.0, 4, 5, 6, 7, 8], [9.0, 10, 11, 12, 13, 14]]}
    nothing = read_loads(pressed, ["F2=3"])
    assert nothing == {"tensions": [0.0, 3.0], "wrenches": [[0.0] * 6] * 2}


@pytest.mark.parametrize("word", ["F3=1", "F1", "F1:5", "=5", "", "f1=5", "tip=1", " F1=5"])
def test_a_word_of_no_load_is_refused_with_the_names_that_there_are(before_a_plane, word):
    with pytest.raises(ValueError) as refused:
        read_loads(before_a_plane, ["F2=1", word])
    assert str(refused.value) == f"loads must be NAME=VALUE, once each, with NAME one of F1, F2, d, got {word}"


def test_a_load_that_is_given_twice_or_no_number_is_refused(before_a_plane):
    with pytest.raises(ValueError, match="once each, with NAME one of F1, F2, d, got F1=2"):
        read_loads(before_a_plane, ["F1=1", "F1=2"])
    for text in ("", "ten", "1,5", "5N", "1=2"):
        with pytest.raises(ValueError) as refused:
            read_loads(before_a_plane, [f"F1={text}"])
        assert str(refused.value) == f"F1 must be a number, got {text!r}"


def test_a_load_outside_the_scene_s_limits_is_refused_with_its_unit(before_a_plane):
    for word, limits in (("F1=100.1", "[0, 100] N"), ("F2=-1", "[0, 100] N"), ("d=20", "[0.001, 0.031] m")):
        name, value = word.split("=")
        with pytest.raises(ValueError) as refused:
            read_loads(before_a_plane, [word])
        assert str(refused.value) == f"{name} must lie in {limits}, got {value}"
