"""Answers: mirror images, plain numbers, and tables that say what is not known."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from rom.answer import FEW, INSIDE, OUTSIDE, Answer

SIDES = st.tuples(st.sampled_from([1, -1]), st.sampled_from([1, -1]))


def answer(seed: int = 0, **fields) -> Answer:
    """At one point, all quantities known."""
    random = np.random.default_rng(seed)
    own = {
        "tip": random.standard_normal(3),
        "contact_force": 1.5,
        "touch_distance": 0.012,
        "pad_pressure": None,
        "error": {"tip": 1e-4, "contact_force": 0.02, "touch_distance": 1e-5},
        "inside": True,
        "orientation": Rotation.from_rotvec(random.uniform(-2, 2, 3)).as_quat(canonical=True, scalar_first=True),
        "orientation_error": 0.004,
        "shortenings": np.array([1e-3, -2e-3]),
        "shortening_error": 1e-5,
    }
    return Answer(**own | fields)


def many(n: int) -> Answer:
    each = {name: np.full(n, value) for name, value in (("contact_force", 1.0), ("touch_distance", 0.01))}
    inside = np.arange(n) % 2 == 0
    error = {"tip": np.ones(n), **each}
    return answer(tip=np.zeros((n, 3)), error=error, inside=inside, orientation=None, shortenings=None, **each)


@given(st.integers(0, 1000), SIDES)
def test_the_mirror_image_s_rotation_is_the_mirrored_rotation(seed, sides):
    """R' = M R M: a quaternion of the same scalar part."""
    one, mirror = answer(seed), np.diag([1, *sides])
    image = one.mirrored(sides)
    turn, other = (Rotation.from_quat(each.orientation, scalar_first=True).as_matrix() for each in (one, image))
    assert other == pytest.approx(mirror @ turn @ mirror) and image.orientation[0] == one.orientation[0] >= 0
    assert image.tip == pytest.approx(mirror @ one.tip)
    again = image.mirrored(sides)
    assert np.array_equal(again.tip, one.tip) and np.array_equal(again.orientation, one.orientation)


def test_plain_numbers_are_strict_json_with_tendons_by_name_and_without_what_is_not_known():
    found = json.loads(json.dumps(answer().as_json(["A", "B"]), allow_nan=False))
    assert found["shortenings_m"] == {"A": 1e-3, "B": -2e-3} and found["inside"] is True
    assert np.linalg.norm(found["orientation_wxyz"]) == pytest.approx(1.0) and "pad_pressure_Pa" not in found
    bare = replace(answer(), orientation=None, shortenings=None, pad_pressure=2e3)
    bare = replace(bare, error={"tip": 1e-4, "pad_pressure": 50.0})
    assert set(bare.as_json([])) == {"tip_m", "tip_error_m", "pad_pressure_Pa", "pad_pressure_error_Pa", "inside"}
    with pytest.raises(ValueError, match="zip"):
        answer().as_json(["A"])


def test_a_table_has_a_row_for_every_quantity_and_a_line_that_says_whether_it_is_inside():
    table, line = answer().tables(["A", "B"])
    rows = {row[0]: row for row in table.rows}
    assert {"contact force", "touch distance", "shortening A", "shortening B", "tip orientation w"} <= set(rows)
    assert rows["contact force"][1:] == ["1.5", "0.02", "N"] and rows["shortening B"][1] == "-2"  # mm
    assert line == INSIDE and answer(inside=False).tables()[1] == OUTSIDE
    free = answer(touch_distance=np.nan).tables()[0]
    assert "touch distance" not in {row[0] for row in free.rows} and len(free.rows) == len(table.rows) - 1


def test_the_angle_of_the_orientation_counts_by_half_in_a_quaternion():
    """A turn by a small angle e moves a unit quaternion by e / 2."""
    one, small = answer(3), 1e-4
    turned = Rotation.from_rotvec([0, 0, small]) * Rotation.from_quat(one.orientation, scalar_first=True)
    moved = np.linalg.norm(turned.as_quat(canonical=True, scalar_first=True) - one.orientation)
    rows = {row[0]: row for row in answer(3, orientation_error=small).tables()[0].rows}
    assert float(rows["tip orientation x"][2]) == pytest.approx(moved, rel=1e-2)


@pytest.mark.parametrize("count", [1, FEW, FEW + 7])
def test_of_many_points_the_first_ones_are_shown_with_what_is_inside(count):
    (table,) = many(count).tables()
    assert len(table.rows) == min(count, FEW) and table.title == f"{min(count, FEW)} of {count} points"
    assert [row[-1] for row in table.rows] == ["yes" if k % 2 == 0 else "no" for k in range(len(table.rows))]


def test_of_several_objects_each_has_its_own_row_and_number():
    two = np.array([1.0, 0.0])
    one = answer(contact_force=two, touch_distance=two, error={"tip": 1e-4, "contact_force": two / 10})
    rows = {row[0]: row for row in one.tables()[0].rows}
    assert rows["contact force 1"][1:3] == ["1", "0.1"] and rows["contact force 2"][1] == "0"
    assert one.as_json(["A", "B"])["contact_force_N"] == [1.0, 0.0]
