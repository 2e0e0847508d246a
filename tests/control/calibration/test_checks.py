"""Logs that cannot be fitted are refused in one line with file, column and row."""

import numpy as np
import pytest
from synthetic_logs import columns, written

import rom
from control import CalibrationOptions, calibrate

ALL = ("F1 [N]", "F2 [N]", "x", "y", "z", "qw", "qx", "qy", "qz")


def changed(**factors):
    """The columns of a good log, of which some are multiplied."""
    values = columns(1)
    return {heading: one * factors.get(heading.split()[0], 1.0) for heading, one in values.items()}


def only(values, rows):
    return {heading: one[rows] for heading, one in values.items()}


def swapped(first, second):
    values = columns(1)
    return values | {first: values[second], second: values[first]}


def constant():
    values = columns(1)
    return values | {"F1 [N]": np.full(30, 20.0), "F2 [N]": np.full(30, 5.0)}


REFUSED = {
    "tensions in mN called N": (
        changed(F1=1e3),
        ALL,
        r"line \d+, F1 \[N\]: must lie in -5 to 300 N.* is \[N\] its unit\?",
    ),
    "pushing tendons": (changed(F2=-1.0), ALL, r"line \d+, F2 \[N\]: must lie in -5 to 300 N, .* got -"),
    "positions in m called mm": (
        changed(x=1e-3, y=1e-3, z=1e-3),
        ALL,
        r"line \d+, [xyz] \[mm\]: position must change about as much as that of the finger, got 0.00\d+ times as much",
    ),
    "positions in um called mm": (
        changed(x=1e3, y=1e3, z=1e3),
        ALL,
        r"line \d+, [xyz] \[mm\]: position must change .* is \[mm\]",
    ),
    "x and y exchanged": (
        swapped("x [mm]", "y [mm]"),
        ALL,
        r"line \d+: x \[mm\] and y \[mm\] must be what the first line says",
    ),
    "tendons exchanged": (
        swapped("F1 [N]", "F2 [N]"),
        ALL,
        r"line \d+: F1 \[N\] and F2 \[N\] must be what the first line says, got a residual of .* if they are exchanged",
    ),
    "one pose": (only(columns(1), slice(1)), ALL, r"must have poses that differ, got one pose \(line 2\)"),
    "constant tension": (constant(), ALL, r"F1 \[N\], F2 \[N\] must not be constant, got the same in lines 2 to 31"),
    "no motors": (
        columns(1),
        ALL[2:],
        r"must have what the motors did, such as F1 \[N\], F2 \[N\], got no such column",
    ),
    "motors alone": (columns(1), ALL[:2], "must have a position, orientation or contact force, got tension alone"),
    "no distance": (columns(1, contact=True), (*ALL, "contact"), "contact force must come with d"),
    "torques without a radius": (
        columns(1),
        ("F1 [N mm]", "F2 [N mm]", "x", "y", "z"),
        r"pulley_radius must be a radius \[m\] for torques or angles in .*got none",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_logs_that_cannot_be_fitted_are_refused_in_one_line(tmp_path, name):
    values, kept, words = REFUSED[name]
    file = written(tmp_path / "log.csv", values, *kept)
    with pytest.raises(ValueError, match=words) as refused:
        calibrate(rom.load(), file)
    assert "\n" not in str(refused.value) and "log.csv" in str(refused.value)


def test_an_empty_cell_of_a_motor_is_named_and_one_of_a_position_is_not_used(tmp_path):
    file = written(tmp_path / "log.csv", columns(1), *ALL)
    lines = file.read_text().splitlines()
    cells = lines[4].split(",")
    file.write_text("\n".join([*lines[:4], ",".join(["", *cells[1:]]), *lines[5:]]))
    with pytest.raises(ValueError, match=r"line 5, F1 \[N\]: must have a number in every line, got an empty cell"):
        calibrate(rom.load(), file)
    file.write_text("\n".join([*lines[:4], ",".join([*cells[:2], "", "", "", *cells[5:]]), *lines[5:]]))
    found = calibrate(rom.load(), file)
    assert found.poses == 30 and found.errors["fit"]["position"]["count"] == 29


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"fit": ["weight"]}, "fit must be of modulus, size, density, pulley_radius, friction, base, got weight"),
        ({"noise": {"position": 0.0}}, "noise must be above 0, of tension, .* got position = 0"),
        ({"pulley_radius": -1.0}, "pulley_radius must be above 0 m, got -1"),
    ],
)
def test_options_out_of_range_are_refused(options, words):
    with pytest.raises(ValueError, match=words):
        CalibrationOptions(**options)


def test_the_density_needs_a_direction_of_the_weight(tmp_path):
    file = written(tmp_path / "log.csv", columns(1), *ALL)
    with pytest.raises(ValueError, match="gravity must be the direction of the weight"):
        calibrate(rom.load(), file, CalibrationOptions(fit=["density"]))
