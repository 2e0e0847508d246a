"""One-dimensional nodal functions: exact where theory says so, and with the right derivatives."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rom.basis1d import coefficients
from rom.separated import Separated


def single(nodes, values, kind) -> Separated:
    return Separated(
        nodes=[np.asarray(nodes)],
        kinds=[kind],
        factors=[np.asarray(values)[:, None]],
        modes=np.ones((1, 1)),
        errors=np.zeros(1),
    )


@given(st.integers(4, 12), st.lists(st.floats(-3, 3), min_size=4, max_size=4), st.floats(0, 1))
def test_splines_reproduce_cubics_and_their_derivatives(n, c, x):
    nodes = np.sort(1 - np.cos(np.linspace(0, np.pi / 2, n)))
    cubic = np.polynomial.Polynomial(c)
    value, gradient = single(nodes, cubic(nodes), "cubic").value_and_gradient([x])
    assert value[0] == pytest.approx(cubic(x), abs=1e-10)
    assert gradient[0, 0] == pytest.approx(cubic.deriv()(x), abs=1e-8)


def test_splines_converge_with_the_fourth_power_of_the_spacing():
    errors = []
    for n in (10, 20, 40):
        nodes = np.linspace(0, 3, n + 1)
        form = single(nodes, np.sin(nodes), "cubic")
        errors.append(max(abs(form.value([x])[0] - np.sin(x)) for x in np.linspace(0, 3, 301)))
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(rates > 3.7)


@pytest.mark.parametrize("kind", ["cubic", "linear"])
def test_nodal_values_are_met(kind):
    nodes = np.array([0.0, 0.1, 0.4, 0.5, 1.0])
    values = np.random.default_rng(0).standard_normal(5)
    form = single(nodes, values, kind)
    assert [form.value([x])[0] for x in nodes] == pytest.approx(values, abs=1e-12)


def test_linear_pieces_do_not_overshoot():
    nodes = np.linspace(0, 1, 6)
    form = single(nodes, (nodes > 0.5).astype(float), "linear")
    values = [form.value([x])[0] for x in np.linspace(0, 1, 101)]
    assert min(values) >= 0 and max(values) <= 1


@pytest.mark.parametrize(
    ("nodes", "values", "kind", "rule"),
    [
        ([0.0], [[1.0]], "cubic", "nodes must ascend"),
        ([0.0, 0.0, 1.0], [[1.0]] * 3, "linear", "nodes must ascend"),
        ([0.0, 1.0], [[1.0]] * 3, "linear", "values must be finite"),
        ([0.0, 1.0], [[1.0], [np.nan]], "linear", "values must be finite"),
        ([0.0, 1.0], [[1.0]] * 2, "quintic", "kind must be one of"),
    ],
)
def test_bad_nodes_are_refused(nodes, values, kind, rule):
    with pytest.raises(ValueError, match=rule):
        coefficients(nodes, np.array(values), kind)
