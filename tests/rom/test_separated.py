"""The compiled sum of products is the sum of products, and its gradient the derivative."""

import numpy as np
import pytest

from rom.separated import Separated


@pytest.fixture(params=[1, 2, 3, 4])
def form(request) -> Separated:
    random, axes = np.random.default_rng(request.param), request.param
    nodes = [np.sort(random.random(6)) for _ in range(axes)]
    return Separated(
        nodes=nodes,
        kinds=["cubic"] * axes,
        factors=[random.standard_normal((6, 5)) for _ in range(axes)],
        modes=random.standard_normal((3, 5)),
        errors=np.array([0.5, 0.2, 0.1, 0.01, 0.001]),
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


def test_truncation_keeps_the_fewest_terms_that_meet_the_tolerance(form):
    assert form.truncated(0.15).terms == 3
    assert form.truncated(0.2).terms == 2
    assert form.truncated(1e-9).terms == 5
    few = form.truncated(0.15)
    x = [nodes.mean() for nodes in form.nodes]
    by_hand = Separated(
        nodes=form.nodes,
        kinds=form.kinds,
        factors=[f[:, :3] for f in form.factors],
        modes=form.modes[:, :3],
        errors=form.errors[:3],
    )
    assert few.value(x) == pytest.approx(by_hand.value(x))


def test_without_axes_it_is_a_constant():
    form = Separated(nodes=[], kinds=[], factors=[], modes=np.array([[2.5]]), errors=np.zeros(1))
    assert form.value([]) == pytest.approx([2.5])
