"""States without contact that are outside the trained domain are named, with the wrench that is."""

import re

import rom
from rom.rod.tables.free_domain import outside_without_contact


def test_fingers_within_their_domain_are_silent():
    for name in ("finger", "round", "square"):
        rod = rom.load(None if name == "finger" else name).rod
        assert outside_without_contact(rod) is None
        assert not any("outside the trained" in str(part) for part in rod.tables())


def test_a_heavy_finger_names_its_states_and_the_wrench_beyond_its_limit():
    heavy = rom.load("round").rod.with_gravity((0.0, 1.0, 0.0), 300.0)
    line = outside_without_contact(heavy)
    assert not heavy.place([0.0] * 4).inside and line in heavy.tables()
    found = re.match(
        r"outside the trained domain without contact at lowest loads, .*; "
        r"segment 1 transmits (f|m)[xyz] = (\S+) N.*, trained to (\S+) N.*: train with a larger load.force",
        line,
    )
    value, limit = (float(one.rstrip(",:")) for one in found.groups()[1:])
    assert value / limit > 1
