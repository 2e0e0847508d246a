"""The compiled sum of products is the sum of products, its gradient the derivative; and it is found from samples."""

from dataclasses import replace

import numpy as np
import pytest

from rom.native import LIBRARY, pointer
from rom.native.forms import memory_of, values
from rom.separated.alternating_directions import EnrichmentOptions
from rom.separated.form import Separated


@pytest.fixture(params=[1, 2, 3, 4])
def form(request) -> Separated:
    random, axes = np.random.default_rng(request.param), request.param
    lower = random.random(axes)
    return Separated(
        ends=np.array([lower, lower + 1 + random.random(axes)]),
        functions=[random.standard_normal((2, 6, 5)) for _ in range(axes)],
        modes=random.standard_normal((3, 5)),
        field=np.zeros((0, 5)),
        errors=np.array([0.5, 0.2, 0.1, 0.01, 0.001]),
    )


def value(form: Separated, x: np.ndarray) -> np.ndarray:
    return values(form.tables, 0, np.atleast_2d(x))[0]


def gradient(form: Separated, x: np.ndarray) -> np.ndarray:
    """By the axes, shape (components, axes)."""
    found, changes = np.empty(len(form.modes)), np.empty((len(form.modes), len(x)))
    arrays = pointer(x), memory_of(form.tables), pointer(found), pointer(changes)
    LIBRARY.functions.fingerfem_form(form.tables, 0, 1, *arrays)
    return changes


def test_at_the_nodes_it_is_the_composed_tensor(form):
    nodes = np.linspace(*form.ends, 6)
    for index in np.ndindex(*[3] * nodes.shape[1]):
        product = np.prod([function[0, i] for function, i in zip(form.functions, index, strict=True)], axis=0)
        assert value(form, nodes[index, range(len(index))]) == pytest.approx(form.modes @ product, abs=1e-10)


def test_gradients_are_differences(form):
    x = form.ends[0] + 0.53 * np.ptp(form.ends, axis=0)
    found = gradient(form, x)
    for a in range(len(x)):
        h = 1e-6 * np.eye(len(x))[a]
        slope = (value(form, x + h) - value(form, x - h)) / 2e-6
        assert found[:, a] == pytest.approx(slope, rel=1e-6, abs=1e-5)


def test_outside_it_goes_on_for_one_interval_and_then_stays(form):
    upper, step = form.ends[1], np.ptp(form.ends, axis=0) / 5
    assert value(form, upper + 10 * step) == pytest.approx(value(form, upper + step))
    assert not gradient(form, upper + 10 * step).any()
    assert gradient(form, upper + 0.5 * step).any()


def test_truncation_keeps_the_fewest_terms_that_meet_the_tolerance_and_says_what_is_lost(form):
    assert form.truncated(0.2)[0].terms == 2
    whole, lost = form.truncated(1e-9)
    assert whole.terms == 5 and not lost.any()
    few, lost = form.truncated(0.15)
    assert few.terms == 3
    nodes = np.stack(np.meshgrid(*np.linspace(*form.ends, 6).T, indexing="ij"), axis=-1).reshape(
        -1, len(form.functions)
    )
    off = np.abs(values(form.tables, 0, nodes) - values(few.tables, 0, nodes))
    assert lost == pytest.approx(np.percentile(off, 95, axis=0))


def test_a_separable_function_is_found_from_samples_with_missing_and_left_out_nodes():
    """u = sin(x) exp(y) + x y and a multiple of it; every second node of x alone, and 2 points missing."""
    x, y = np.linspace(0, 1, 9)[[0, 2, 4, 5, 6, 8]], np.linspace(1, 2, 6)
    at = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    u = np.sin(at[..., 0]) * np.exp(at[..., 1]) + at.prod(axis=-1)
    by = np.stack([np.cos(at[..., 0]) * np.exp(at[..., 1]) + at[..., 1], u - at.prod(axis=-1) + at[..., 0]], axis=-1)
    samples, gradient = np.stack([u, 3 * u], axis=-1), by[..., None, :]
    for missing in ((2, 3), (4, 0)):
        samples[missing], gradient[missing] = np.nan, np.nan
    form = Separated.of([x, y], samples, gradient, EnrichmentOptions(terms=2, sweeps=1000))
    further = replace(form, modes=form.field)
    for point in ([0.5, 1.6], [0.31, 1.05], [0.93, 1.77]):
        true = np.sin(point[0]) * np.exp(point[1]) + np.prod(point)
        assert value(form, np.array(point)) == pytest.approx(true, rel=1e-4)
        assert value(further, np.array(point)) == pytest.approx(3 * true, rel=5e-3)
