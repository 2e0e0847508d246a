"""A finger as one C header: an example that is in contact, exact limits, and names of its own."""

import re

import numpy as np
import pytest

from rom.export.rod_header import _about, _ends, _filled, _limited, _limits, _stack, rod_header
from rom.files.checked_file import ModelError
from rom.native import LIBRARY


def test_the_example_s_point_is_in_contact_and_inside(model):
    point = [float(one) for one in _about(model)["EXAMPLE"].split(",")]
    answer = model.evaluate(point)
    assert answer.inside and answer.contact_force > 0.1 and point[-1] < answer.touch_distance
    assert float(_about(model)["HALF"]) == model.rod.half_lengths[1]


def test_a_title_cannot_end_the_comment_that_it_stands_in(model):
    model.rod.scene["name"], kept = "a */ #error \\ ?", model.rod.scene["name"]
    try:
        title = _about(model)["TITLE"]
    finally:
        model.rod.scene["name"] = kept
    assert re.fullmatch(r"[\w .,:()-]+", title) and title.startswith("a ") and "error" in title


def test_the_ends_of_the_box_are_written_to_the_last_bit(model):
    text = _ends(model, "arm")
    for name, end in zip(("lower", "upper"), model.limits, strict=True):
        (numbers,) = re.findall(rf"const double arm_{name}\[arm_TENSIONS \+ 1\] = {{(.*?)}};", text)
        read = [float.fromhex(one) if "x" in one else float(one) for one in numbers.split(",")]
        assert np.array_equal(read, end)


def test_limits_are_the_finger_s_own_and_need_less_stack_than_the_library_s(model):
    own, most = _limits(model), {name: getattr(LIBRARY.constants, name) for name in _limits(model)}
    assert own["FINGERFEM_MOST_PLATES"] == 1 and own["FINGERFEM_MOST_ELEMENTS"] == len(model.rod.pieces[0])
    powers = [int(law.polynomial.powers.max()) for law in model.rod.elements.laws.values()]
    assert max(powers) <= own["FINGERFEM_MOST_POWER"] <= most["FINGERFEM_MOST_POWER"]
    assert _stack(own) < _stack(most)
    assert own["FINGERFEM_MOST_VERTICES"] == 1  # a square needs none
    limits = {"PLATES": 8, "ELEMENTS": 99, "POWER": 31, "VERTICES": 64}
    declared = "".join(f"enum {{ x__FINGERFEM_MOST_{name} = {value} }};" for name, value in limits.items())
    found = dict(re.findall(r"x__(\w+) = (\d+)", _limited(declared, own)))
    assert {name: int(value) for name, value in found.items()} == own


@pytest.mark.parametrize("times", [0, 2])
def test_a_limit_that_the_sources_do_not_define_once_is_refused(model, times):
    limits = _limits(model)
    code = "".join(f"enum {{ x__{name} = 8 }};" for name in limits if name != "FINGERFEM_MOST_POWER")
    with pytest.raises(ModelError, match=f"sources must define FINGERFEM_MOST_POWER once, got {times} times"):
        _limited(code + "enum { x__FINGERFEM_MOST_POWER = 31 };" * times, limits)


def test_a_template_s_places_are_filled_and_an_unknown_one_is_an_error():
    assert _filled("@_place(@SIZE@) @", "arm", {"SIZE": "3"}) == "arm_place(3) arm"
    with pytest.raises(KeyError):
        _filled("@SIZES@", "arm", {"SIZE": "3"})


@pytest.mark.long
def test_two_headers_have_no_name_in_common_but_the_objects(model):
    """Names of functions and of constants that have a linkage or a type."""
    names = []
    for name in ("left", "right"):
        text = rod_header(model, name)
        names.append(set(re.findall(r"\b[a-z_]+__\w+|\b(?:left|right)_\w+", text)))
        assert "@" not in text.replace("@param", "")
    assert len(names[0]) == len(names[1]) > 200 and not names[0] & names[1]
