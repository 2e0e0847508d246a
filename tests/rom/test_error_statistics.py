"""Errors in few numbers: closed forms of their quantiles, and which states count."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rom.error_statistics import FELT, PRESSED, REST, compared, differences, mean_size, quantiles, statistics

SEEDS = st.integers(0, 10_000)
TRUE = {
    "tip": np.array([[3e-3, 4e-3, 0.0], [0.0, 0.0, 2e-3], [0.0, 0.0, REST / 2]]),
    "contact_force": np.array([2 * FELT, FELT / 2, 10 * FELT]),
    "pad_pressure": np.array([1e4, 1e4 * PRESSED / 2, 1e4 * PRESSED * 2]),
}
ERROR = {"tip": np.full(3, 1e-3), "contact_force": np.full(3, 0.05), "pad_pressure": np.full(3, 1.0)}


def test_quantiles_of_an_even_spread_are_its_shares_whatever_the_order():
    size = np.full(1001, 4.0)
    errors = 4.0 * np.random.default_rng(0).permutation(np.linspace(0, 1, 1001))
    found = statistics(errors, size, np.full(1001, 1.0))
    assert (found["median"], found["p95"], found["max"]) == pytest.approx((0.5, 0.95, 1.0))
    assert found["p95_absolute"] == pytest.approx(3.8) and found["count"] == 1001
    assert found["coverage"] == pytest.approx(0.25, abs=1e-3)  # a quarter of all errors is at most 1
    assert quantiles(np.append(errors / 4, [np.nan] * 7)) == pytest.approx(
        {"median": 0.5, "p95": 0.95, "max": 1.0, "count": 1001}
    )


@given(SEEDS, st.floats(1e-6, 1e6))
def test_relative_errors_do_not_depend_on_the_unit(seed, unit):
    random = np.random.default_rng(seed)
    errors, sizes = random.random(20), 0.1 + random.random(20)
    one, other = statistics(errors, sizes, 0.5 * sizes), statistics(unit * errors, unit * sizes, unit * 0.5 * sizes)
    assert other.pop("p95_absolute") == pytest.approx(unit * one.pop("p95_absolute"))
    assert other == pytest.approx(one)


def test_without_states_there_is_a_count_of_none_and_nothing_fails():
    assert statistics(np.zeros(0), np.zeros(0), np.zeros(0)) == {"count": 0}
    found = quantiles([np.nan, np.nan])
    assert found["count"] == 0 and np.isnan([found["median"], found["p95"], found["max"]]).all()


@given(SEEDS)
def test_the_mean_size_of_a_field_does_not_see_rotations_and_of_a_constant_is_its_length(seed):
    random = np.random.default_rng(seed)
    field, turn = random.standard_normal((9, 3)), np.linalg.qr(random.standard_normal((3, 3)))[0]
    assert mean_size(field @ turn.T) == pytest.approx(mean_size(field))
    assert mean_size(np.tile([2.0, 3.0, 6.0], (5, 1))) == pytest.approx(7.0)


def test_states_count_where_they_are_inside_and_large_enough_to_be_relative_to():
    off = 0.01 * np.ones(3)
    answer = SimpleNamespace(**{name: value + 0.01 for name, value in TRUE.items()}, error=ERROR)
    found = compared(answer, TRUE, dict.fromkeys(TRUE, off), np.array([True, True, True]))
    counts = {name: one["count"] for name, one in found.items()}
    assert counts == {"tip": 2, "contact_force": 2, "pad_pressure": 2}
    assert found["tip"]["max"] == pytest.approx(0.01 / 2e-3) and found["tip"]["coverage"] == 0.0
    assert found["contact_force"]["max"] == pytest.approx(0.01 / (2 * FELT)) and found["contact_force"]["coverage"] == 1
    none = compared(answer, TRUE, dict.fromkeys(TRUE, off), np.zeros(3, bool))
    assert all(one == {"count": 0} for one in none.values())


def test_differences_are_lengths_of_vectors_and_leave_out_what_an_answer_does_not_have():
    answer = SimpleNamespace(tip=TRUE["tip"] + [0.0, 3e-3, -4e-3], contact_force=TRUE["contact_force"] - 0.2)
    found = differences(answer, TRUE)
    assert set(found) == {"tip", "contact_force"}
    assert found["tip"] == pytest.approx(np.full(3, 5e-3)) and found["contact_force"] == pytest.approx(np.full(3, 0.2))
