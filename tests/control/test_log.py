"""Logs of a finger are read by the names and units of their columns; all other files are refused in one line."""

import numpy as np
import pytest

from control.log import read_log, write_log

HEADER = "F1 [N],F2 [N],x [mm],y [mm],z [mm],qw [-],qx [-],qy [-],qz [-],contact force [mN],d [mm],t [s]"
ROWS = ["10,0,48.1,12,0,1,0,0,0,500,10,0.0", "20,5,47,20,0.5,0.99,0,0,0.14,,9,0.5"]


def written(folder, lines):
    file = folder / "log.csv"
    file.write_text("\n".join(lines) + "\n", "utf-8")
    return file


def test_values_are_in_si_units_and_an_empty_cell_is_nan(tmp_path):
    log = read_log(written(tmp_path, ["# by hand", HEADER, *ROWS]), ["F1", "F2"])
    assert log.tension.tolist() == [[10, 0], [20, 5]]
    assert log.position == pytest.approx(1e-3 * np.array([[48.1, 12, 0], [47, 20, 0.5]]))
    assert log.contact_force[0] == pytest.approx(0.5) and np.isnan(log.contact_force[1])
    assert np.linalg.norm(log.orientation, axis=1) == pytest.approx(1)
    assert np.isnan(log.shortening).all() and not log.has("shortening") and log.has("tension") and log.has("x")
    assert log.lines.tolist() == [3, 4] and len(log.digest) == 64
    assert log.where(1, "x").endswith("log.csv, line 4, x [mm]")


def test_the_order_of_columns_does_not_matter(tmp_path):
    order = np.random.default_rng(3).permutation(12)
    lines = [",".join(line.split(",")[k] for k in order) for line in (HEADER, *ROWS)]
    (tmp_path / "b").mkdir()
    one, other = (
        read_log(written(tmp_path / at, those), ["F1", "F2"]) for at, those in (("", [HEADER, *ROWS]), ("b", lines))
    )
    for name in ("tension", "position", "orientation", "contact_force", "distance", "time"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_the_unit_of_a_tendons_column_decides_what_was_measured(tmp_path):
    lines = ["F1 [N],F1 [mm],F1 [N mm],F1 [deg]", "10,2,100,90"]
    log = read_log(written(tmp_path, lines), ["F1"])
    found = [getattr(log, name)[0, 0] for name in ("tension", "shortening", "torque", "angle")]
    assert found == pytest.approx([10, 0.002, 0.1, np.pi / 2])


def test_a_rotation_vector_is_a_quaternion(tmp_path):
    log = read_log(written(tmp_path, ["rx [deg];ry [deg];rz [deg]", "0,0;0;90,0", "0;0;0"]), ["F1"])
    assert log.orientation == pytest.approx(np.array([[0.5**0.5, 0, 0, 0.5**0.5], [1, 0, 0, 0]]))


def test_what_is_written_is_read(tmp_path):
    given = {"F1 [N]": [1.0, 2.0], "x [mm]": [0.1, np.nan], "d [mm]": [3.0, 4.0]}
    log = read_log(write_log(tmp_path / "log.csv", given, "by hand"), ["F1"])
    assert log.tension.tolist() == [[1.0], [2.0]] and log.lines.tolist() == [3, 4]
    np.testing.assert_array_equal(log.position[:, 0], [1e-3 * 0.1, np.nan])


def test_ignored_columns_are_not_read(tmp_path):
    lines = ["F1 [N],temperature [K],note", "1,290,warm"]
    assert read_log(written(tmp_path, lines), ["F1"], ignored=["temperature", "note"]).tension.tolist() == [[1]]


REFUSED = {
    "no rows": (["F1 [N],x [mm]"], "must have a line of numbers, got none"),
    "no unit": (["F1 [N],x", "1,2"], r"line 1: x must name its unit in brackets, one of mm, m, cm"),
    "wrong unit": (["F1 [N],x [N]", "1,2"], r"line 1: x \[N\] must name its unit in brackets, one of mm"),
    "unknown tendon unit": (["F1 [bar]", "1"], r"line 1: F1 \[bar\] must name its unit in brackets, one of N, mN"),
    "unknown column": (["F1 [N],tip [mm]", "1,2"], r"line 1: columns must be of F1, t, x.* got tip \[mm\]"),
    "column twice": (["F1 [N],F1 [mN]", "1,2"], r"must have one column of tension F1, got F1 \[N\], F1 \[mN\]"),
    "NaN": (["F1 [N],x [mm]", "1,2", "nan,3"], r"line 3: F1 must be a finite number, \[N\], got 'nan'"),
    "text": (["F1 [N],x [mm]", "1,left"], r"line 2: x must be a finite number, \[mm\], got 'left'"),
    "few cells": (["F1 [N],x [mm]", "1"], "line 2: must have 2 cells, as the first line, got 1"),
    "part of a quaternion": (["F1 [N],qw [-]", "1,1"], "must have all of qw, qx, qy, qz or none, got no qx"),
    "two orientations": (
        ["qw [-],qx [-],qy [-],qz [-],rx [rad],ry [rad],rz [rad]", "1,0,0,0,0,0,0"],
        "must have an orientation once",
    ),
    "no unit quaternion": (["qw [-],qx [-],qy [-],qz [-]", "1,1,0,0"], "line 2: .* must be a unit quaternion"),
    "time goes back": (["t [s],F1 [N]", "1,2", "0.5,3"], r"line 3, t \[s\]: must be after the line before, got 0.5 s"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_other_files_are_refused_in_one_line(tmp_path, name):
    lines, words = REFUSED[name]
    with pytest.raises(ValueError, match=words) as refused:
        read_log(written(tmp_path, lines), ["F1"])
    assert "\n" not in str(refused.value) and str(tmp_path) in str(refused.value)


def test_a_tendon_without_a_column_is_named(tmp_path):
    with pytest.raises(ValueError, match="must have all of tension F1, tension F2 or none, got no tension F2"):
        read_log(written(tmp_path, ["F1 [N]", "1"]), ["F1", "F2"])
