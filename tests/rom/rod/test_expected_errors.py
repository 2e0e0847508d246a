"""Errors that a finger is expected to have: how they grow with its size, its length and its taper."""

from dataclasses import astuple

import pytest
from hypothesis import given
from hypothesis import strategies as st

import rom
from rom.rod.expected_errors import NOTHING, Added, expected_errors

RATIOS = st.floats(1.0, 10.0)
NAMES = "position", "turn", "shortening", "contact_force"
ELEMENTS = rom.load().rod.elements


def errors(size=1.0, longer=1.0, added=NOTHING, kinds=("clamp", "interior", "plate")):
    return expected_errors(ELEMENTS, kinds, size, longer, added)


def test_those_of_the_trained_finger_are_those_of_the_lines_left_out():
    found, left_out = errors(), ELEMENTS.provenance["left_out"]
    assert found.position == left_out["free_place_m"]["p95"] and found.turn == left_out["turn_rad"]["p95"]
    assert found.contact_force == left_out["contact_force"]["p95"]
    outlines = [law.error for law in ELEMENTS.outlines.values()]
    assert found.surface == pytest.approx(max(outlines) + found.position)


@given(st.floats(0.1, 10.0), RATIOS)
def test_turns_act_with_the_length_as_their_lever(size, longer):
    one, other = errors(), errors(size, longer)
    factors = [getattr(other, name) / getattr(one, name) for name in NAMES]
    assert factors == pytest.approx([size * longer**2, longer, size * longer, 1.0])
    assert other.floors.place / one.floors.place == pytest.approx(size * longer**2)
    assert other.floors.force == one.floors.force


@given(st.floats(0.01, 1.0))
def test_a_shorter_finger_is_not_expected_to_be_better(longer):
    assert astuple(errors(longer=longer)) == astuple(errors())


@given(RATIOS, RATIOS, st.builds(Added, *[st.floats(0, 0.02)] * 4))
def test_changes_along_the_axis_add_their_own_errors_to_any_finger(size, longer, added):
    even, changing = errors(size, longer), errors(size, longer, added)
    for name, value in added._asdict().items():
        assert getattr(changing, name) - getattr(even, name) == pytest.approx(value, abs=1e-12)
    assert changing.surface - even.surface == pytest.approx(added.position, abs=1e-12)
    floors = changing.floors.place - even.floors.place, changing.floors.force - even.floors.force
    assert floors == pytest.approx((added.position, added.contact_force), abs=1e-12)
