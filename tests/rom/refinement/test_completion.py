"""A grid completed by values and derivatives: exact where it should be, and in doubt where it should be."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rom.refinement.completion import KnownGrid, complete

X = (1 - np.cos(np.pi * np.arange(17) / 16)) / 2
Y = np.linspace(0, 1, 9)


def known(value, by_x, by_y, strides, extra=()) -> KnownGrid:
    x, y = np.meshgrid(X, Y, indexing="ij")
    inside = np.zeros(x.shape, bool)
    inside[:: strides[0], :: strides[1]] = True
    for node in extra:
        inside[node] = True
    grids = [np.where(inside, f(x, y), np.nan)[..., None] for f in (value, by_x, by_y)]
    return KnownGrid(axes=[X, Y], strides=strides, known=inside, values=grids[0], slopes=grids[1:])


@given(st.lists(st.floats(-2, 2), min_size=16, max_size=16))
def test_cubic_products_are_completed_exactly_and_without_doubt(numbers):
    c = np.array(numbers).reshape(4, 4)
    poly = np.polynomial.polynomial
    function = known(
        lambda x, y: poly.polyval2d(x, y, c),
        lambda x, y: poly.polyval2d(x, y, poly.polyder(c, axis=0)),
        lambda x, y: poly.polyval2d(x, y, poly.polyder(c, axis=1)),
        (4, 2),
    )
    found = complete(function)
    x, y = np.meshgrid(X, Y, indexing="ij")
    assert np.abs(found.values[..., 0] - poly.polyval2d(x, y, c)).max() < 1e-12 * (1 + np.abs(c).sum())
    assert found.error.max() < 1e-12 * (1 + np.abs(c).sum())


def test_what_is_known_stays_bit_for_bit_and_a_complete_grid_needs_no_derivatives():
    extra = [(3, 5), (8, 1)]
    function = known(lambda x, y: np.sin(9 * x * y), lambda x, y: 0 * x, lambda x, y: 0 * x, (4, 2), extra)
    found = complete(function)
    assert np.array_equal(found.values[function.known], function.values[function.known])
    assert not found.doubt[function.known].any() and not found.error[function.known].any()
    whole = known(lambda x, y: x + y, lambda x, y: 0 * x, lambda x, y: 0 * x, (1, 1))
    bare = KnownGrid(axes=whole.axes, strides=(1, 1), known=whole.known, values=whole.values, slopes=[])
    assert np.array_equal(complete(bare).values, whole.values)


def test_of_a_smooth_function_the_estimated_error_covers_the_true_one():
    for a in (2.0, 4.0, 6.0):
        function = known(
            lambda x, y, a=a: np.sin(a * x + 2 * y),
            lambda x, y, a=a: a * np.cos(a * x + 2 * y),
            lambda x, y, a=a: 2 * np.cos(a * x + 2 * y),
            (4, 2),
        )
        x, y = np.meshgrid(X, Y, indexing="ij")
        found = complete(function)
        true = np.abs(found.values[..., 0] - np.sin(a * x + 2 * y))
        assert np.percentile(true, 95) <= np.percentile(found.error, 95)
        assert true.max() < 0.05


@pytest.mark.parametrize("kink", [0.1, 0.25, 0.4, 0.6, 0.8])
def test_a_kink_is_in_doubt_in_its_cell_and_those_beside(kink):
    function = known(
        lambda x, y: np.maximum(x - kink, 0) + 0 * y, lambda x, y: 1.0 * (x > kink), lambda x, y: 0 * x, (4, 2)
    )
    doubt = complete(function).doubt[..., 0].max(axis=1)
    cell = 4 * (np.searchsorted(X[::4], kink) - 1)
    near = doubt[max(cell - 4, 0) : cell + 9]
    far = np.concatenate([doubt[: max(cell - 4, 0)], doubt[cell + 9 :]])
    assert near.max() > 1e-3 and far.max(initial=0) < 0.2 * near.max()


def test_nodes_are_predicted_coarse_ones_first():
    function = known(lambda x, y: x, lambda x, y: 1 + 0 * x, lambda x, y: 0 * x, (4, 2))
    stages = complete(function).stages
    assert not stages[::4, ::2].any()
    assert np.all(stages[2::4, ::2] == 1) and np.all(stages[::2, 1::2] == 2) and np.all(stages[1::2] == 3)


def test_a_derivative_that_is_not_known_at_an_open_end_is_not_used():
    x, y = np.meshgrid(X, Y, indexing="ij")
    value, slope = x**3 + y, 3 * x**2
    slope[0] = 1e6  # wrong on purpose
    grids = [array[..., None] for array in (value, slope, np.ones_like(x))]
    inside = np.zeros(x.shape, bool)
    inside[::4, ::2] = True
    function = KnownGrid(axes=[X, Y], strides=(4, 2), known=inside, values=grids[0], slopes=grids[1:], open=(0,))
    assert np.abs(complete(function).values[..., 0] - value).max() < 1e-12
