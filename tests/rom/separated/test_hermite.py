"""One-dimensional nodal functions: exact where theory says so, and with the right derivatives."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rom.separated.separated_form import cubic_pieces


def value(nodes, pieces, x):
    """Value and derivative at x, by the definition in `cubic_pieces`."""
    i = min(max(int(np.searchsorted(nodes, x, side="right")) - 1, 0), len(pieces) - 1)
    step = nodes[i + 1] - nodes[i]
    cubic = np.polynomial.Polynomial(pieces[i][:, 0])
    t = (x - nodes[i]) / step
    return cubic(t), cubic.deriv()(t) / step


@given(st.integers(4, 12), st.lists(st.floats(-3, 3), min_size=4, max_size=4), st.floats(0, 1))
def test_cubics_and_their_derivatives_are_reproduced(n, c, x):
    nodes = np.sort(1 - np.cos(np.linspace(0, np.pi / 2, n)))
    cubic = np.polynomial.Polynomial(c)
    pieces = cubic_pieces(nodes, cubic(nodes)[:, None], cubic.deriv()(nodes)[:, None])
    found, slope = value(nodes, pieces, x)
    assert found == pytest.approx(cubic(x), abs=1e-10)
    assert slope == pytest.approx(cubic.deriv()(x), abs=1e-8)


def test_the_error_falls_with_the_fourth_power_of_the_spacing():
    errors = []
    for n in (10, 20, 40):
        nodes = np.linspace(0, 3, n + 1)
        pieces = cubic_pieces(nodes, np.sin(nodes)[:, None], np.cos(nodes)[:, None])
        errors.append(max(abs(value(nodes, pieces, x)[0] - np.sin(x)) for x in np.linspace(0, 3, 301)))
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(rates > 3.7)


def test_nodal_values_and_slopes_are_met():
    nodes = np.array([0.0, 0.1, 0.4, 0.5, 1.0])
    values, slopes = np.random.default_rng(0).standard_normal((2, 5, 1))
    pieces = cubic_pieces(nodes, values, slopes)
    assert [value(nodes, pieces, x)[0] for x in nodes] == pytest.approx(values[:, 0], abs=1e-12)
    assert [value(nodes, pieces, x)[1] for x in nodes] == pytest.approx(slopes[:, 0], abs=1e-10)


@pytest.mark.parametrize(
    ("nodes", "values", "slopes", "rule"),
    [
        ([0.0], [[1.0]], [[1.0]], "nodes must ascend"),
        ([0.0, 0.0, 1.0], [[1.0]] * 3, [[1.0]] * 3, "nodes must ascend"),
        ([0.0, 1.0], [[1.0]] * 3, [[1.0]] * 3, "values must be finite"),
        ([0.0, 1.0], [[1.0], [np.nan]], [[1.0]] * 2, "values must be finite"),
        ([0.0, 1.0], [[1.0]] * 2, [[1.0]], "slopes must be finite"),
        ([0.0, 1.0], [[1.0]] * 2, [[1.0], [np.inf]], "slopes must be finite"),
    ],
)
def test_bad_nodes_are_refused(nodes, values, slopes, rule):
    with pytest.raises(ValueError, match=rule):
        cubic_pieces(nodes, np.array(values), np.array(slopes))
