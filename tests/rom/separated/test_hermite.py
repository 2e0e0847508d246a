"""One-dimensional nodal functions: exact where theory says so, and with the right derivatives."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rom.separated.form import cubic_pieces


def value(nodes, pieces, x):
    """Value and derivative at x, by the definition in `cubic_pieces`."""
    step = nodes[1] - nodes[0]
    i = min(int((x - nodes[0]) / step), len(pieces) - 1)
    cubic = np.polynomial.Polynomial(pieces[i][:, 0])
    t = (x - nodes[i]) / step
    return cubic(t), cubic.deriv()(t) / step


@given(st.integers(2, 12), st.lists(st.floats(-3, 3), min_size=4, max_size=4), st.floats(0, 1))
def test_cubics_and_their_derivatives_are_reproduced(n, c, x):
    nodes, cubic = np.linspace(0, 1, n), np.polynomial.Polynomial(c)
    pieces = cubic_pieces(cubic(nodes)[:, None], cubic.deriv()(nodes)[:, None], 1 / (n - 1))
    found, slope = value(nodes, pieces, x)
    assert found == pytest.approx(cubic(x), abs=1e-10)
    assert slope == pytest.approx(cubic.deriv()(x), abs=1e-8)


def test_the_error_falls_with_the_fourth_power_of_the_spacing():
    errors = []
    for n in (10, 20, 40):
        nodes = np.linspace(0, 3, n + 1)
        pieces = cubic_pieces(np.sin(nodes)[:, None], np.cos(nodes)[:, None], 3 / n)
        errors.append(max(abs(value(nodes, pieces, x)[0] - np.sin(x)) for x in np.linspace(0, 3, 301)))
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(rates > 3.7)
