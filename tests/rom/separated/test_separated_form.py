"""The compiled sum of products is the sum of products, and its gradient the derivative."""

import numpy as np
import pytest

from rom.separated.separated_form import Separated


@pytest.fixture(params=[1, 2, 3, 4])
def form(request) -> Separated:
    random, axes = np.random.default_rng(request.param), request.param
    lower = random.random(axes)
    return Separated(
        lower=lower,
        upper=lower + 1 + random.random(axes),
        factors=[random.standard_normal((6, 5)) for _ in range(axes)],
        slopes=[random.standard_normal((6, 5)) for _ in range(axes)],
        modes=random.standard_normal((3, 5)),
        errors=np.array([0.5, 0.2, 0.1, 0.01, 0.001]),
        lost=np.array([[0.5], [0.2], [0.1], [0.01], [0.001]]) * [1, 2, 3],
    )


def test_at_the_nodes_it_is_the_composed_tensor(form):
    for index in np.ndindex(*[3] * len(form.nodes)):
        product = np.prod([factor[i] for factor, i in zip(form.factors, index, strict=True)], axis=0)
        x = [nodes[i] for nodes, i in zip(form.nodes, index, strict=True)]
        assert form.value(x) == pytest.approx(form.modes @ product, abs=1e-10)


def test_gradients_are_differences(form):
    x = np.array([nodes[[2, 3]].mean() for nodes in form.nodes])
    _, gradient = form.value_and_gradient(x)
    for a in range(len(x)):
        h = 1e-6 * np.eye(len(x))[a]
        slope = (form.value(x + h) - form.value(x - h)) / 2e-6
        assert gradient[:, a] == pytest.approx(slope, rel=1e-6, abs=1e-5)


def test_outside_it_goes_on_for_one_interval_and_then_stays(form):
    step = (form.upper - form.lower) / 5
    far, edge = form.upper + 10 * step, form.upper + step
    assert form.value(far) == pytest.approx(form.value(edge))
    assert not form.value_and_gradient(far)[1].any()
    beyond = form.value_and_gradient(form.upper + 0.5 * step)[1]
    assert beyond.any()


def test_truncation_keeps_the_fewest_terms_that_meet_the_tolerance_and_says_what_is_lost(form):
    assert form.truncated(0.15)[0].terms == 3
    assert form.truncated(0.2)[0].terms == 2
    whole, lost = form.truncated(1e-9)
    assert whole.terms == 5 and not lost.any()
    few, lost = form.truncated(0.15)
    assert lost == pytest.approx(0.099 * np.array([1, 2, 3]))
    x = np.array([nodes[0] for nodes in form.nodes])
    product = np.prod([factor[0, :3] for factor in form.factors], axis=0)
    assert few.value(x) == pytest.approx(form.modes[:, :3] @ product)
