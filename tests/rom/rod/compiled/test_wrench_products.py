"""Products of a wrench in the order of compiled code: none is lost, and few are added."""

from itertools import product

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from rom.rod.compiled.wrench_products import NONE, padded

ROWS = st.lists(st.tuples(*[st.integers(0, 3)] * 6), min_size=1, max_size=40)


def pairs(powers) -> set:
    return {(tuple(row[:3]), tuple(row[3:])) for row in np.asarray(powers).tolist()}


@given(ROWS)
def test_every_product_is_among_those_that_are_summed(rows):
    forces, moments, counts = padded(np.array(rows))
    summed = [(a, b) for a, count in zip(forces, counts, strict=True) for b in moments[:count]]
    assert pairs(rows) <= set(summed) and len(set(summed)) == len(summed)
    assert moments[0] == NONE and {a for a, _ in pairs(rows)} == set(forces)


@given(ROWS)
def test_counts_descend_and_none_is_larger_than_it_needs_to_be(rows):
    forces, moments, counts = padded(np.array(rows))
    assert counts == sorted(counts, reverse=True) and max(counts) <= len(moments)
    for a, count in zip(forces, counts, strict=True):
        assert count == 1 or (a, moments[count - 1]) in pairs(rows)


@given(ROWS, st.randoms(use_true_random=False))
def test_the_order_of_the_polynomials_and_repetitions_do_not_matter(rows, random):
    others = [*rows, rows[0]]
    random.shuffle(others)
    assert padded(np.array(others)) == padded(np.array(rows))


def test_of_a_total_degree_nothing_is_missing():
    rows = np.array([row for row in product(range(4), repeat=6) if sum(row) <= 3])
    forces, moments, counts = padded(rows)
    assert sum(counts) == len(rows) == 84 and len(forces) == len(moments) == 20
