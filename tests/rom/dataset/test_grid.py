"""Coordinates that are equal up to round-off are one, wherever a rounding limit lies."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rom.dataset.grid import levels


@given(st.lists(st.floats(1e-3, 1.0), min_size=2, max_size=30), st.floats(-4, 1), st.integers(0, 2**32))
def test_nodes_with_round_off_have_the_coordinates_of_their_grid(cells, exponent, seed):
    line = np.concatenate([[0.0], np.cumsum(cells)]) * 10**exponent
    random = np.random.default_rng(seed)
    index = random.permutation(np.repeat(np.arange(len(line)), 5))
    values = line[index] * (1 + 2.0**-52 * random.integers(-8, 9, len(index)))
    for stored in (values, values.astype(np.float32)):
        found, own = levels(stored)
        assert found == pytest.approx(line, rel=1e-6) and np.array_equal(own, index)


def test_two_values_on_both_sides_of_a_rounding_limit_are_one():
    half = 1.5e-9 + np.array([-1e-17, 1e-17])
    assert len(set(np.round(half, 9))) == 2
    found, own = levels(np.append(half, 0.01))
    assert len(found) == 2 and own.tolist() == [0, 0, 1]


def test_no_values_have_no_levels():
    assert [len(part) for part in levels(np.zeros(0))] == [0, 0]
