"""One-dimensional nodal functions: exact where theory says so, and with the right derivatives."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rom.separation.hermite import coefficients


def value(nodes, pieces, x):
    """Value and derivative at x, by the definition in rom.separation.hermite."""
    i = min(max(int(np.searchsorted(nodes, x, side="right")) - 1, 0), len(pieces) - 1)
    step = nodes[i + 1] - nodes[i]
    cubic = np.polynomial.Polynomial(pieces[i][:, 0])
    t = (x - nodes[i]) / step
    return cubic(t), cubic.deriv()(t) / step


@given(st.integers(4, 12), st.lists(st.floats(-3, 3), min_size=4, max_size=4), st.floats(0, 1))
@pytest.mark.parametrize("kind", ["cubic", "hermite"])
def test_cubics_and_their_derivatives_are_reproduced(kind, n, c, x):
    nodes = np.sort(1 - np.cos(np.linspace(0, np.pi / 2, n)))
    cubic = np.polynomial.Polynomial(c)
    pieces = coefficients(nodes, cubic(nodes)[:, None], kind, cubic.deriv()(nodes)[:, None])
    found, slope = value(nodes, pieces, x)
    assert found == pytest.approx(cubic(x), abs=1e-10)
    assert slope == pytest.approx(cubic.deriv()(x), abs=1e-8)


@pytest.mark.parametrize(("kind", "rate"), [("cubic", 4), ("hermite", 4), ("linear", 2)])
def test_the_error_falls_with_the_power_of_the_spacing_that_theory_says(kind, rate):
    errors = []
    for n in (10, 20, 40):
        nodes = np.linspace(0, 3, n + 1)
        pieces = coefficients(nodes, np.sin(nodes)[:, None], kind, np.cos(nodes)[:, None])
        errors.append(max(abs(value(nodes, pieces, x)[0] - np.sin(x)) for x in np.linspace(0, 3, 301)))
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(rates > rate - 0.3)


@pytest.mark.parametrize("kind", ["cubic", "hermite", "linear"])
def test_nodal_values_are_met(kind):
    nodes = np.array([0.0, 0.1, 0.4, 0.5, 1.0])
    values, slopes = np.random.default_rng(0).standard_normal((2, 5, 1))
    pieces = coefficients(nodes, values, kind, slopes)
    assert [value(nodes, pieces, x)[0] for x in nodes] == pytest.approx(values[:, 0], abs=1e-12)
    if kind == "hermite":
        assert [value(nodes, pieces, x)[1] for x in nodes] == pytest.approx(slopes[:, 0], abs=1e-10)


def test_linear_pieces_do_not_overshoot():
    nodes = np.linspace(0, 1, 6)
    pieces = coefficients(nodes, (nodes > 0.5).astype(float)[:, None], "linear")
    values = [value(nodes, pieces, x)[0] for x in np.linspace(0, 1, 101)]
    assert min(values) >= 0 and max(values) <= 1


@pytest.mark.parametrize(
    ("nodes", "values", "kind", "rule"),
    [
        ([0.0], [[1.0]], "cubic", "nodes must ascend"),
        ([0.0, 0.0, 1.0], [[1.0]] * 3, "linear", "nodes must ascend"),
        ([0.0, 1.0], [[1.0]] * 3, "linear", "values must be finite"),
        ([0.0, 1.0], [[1.0], [np.nan]], "linear", "values must be finite"),
        ([0.0, 1.0], [[1.0]] * 2, "quintic", "kind must be one of"),
        ([0.0, 1.0], [[1.0]] * 2, "hermite", "slopes must be finite"),
    ],
)
def test_bad_nodes_are_refused(nodes, values, kind, rule):
    with pytest.raises(ValueError, match=rule):
        coefficients(nodes, np.array(values), kind)
