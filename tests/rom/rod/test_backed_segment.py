"""The bundled map with the bundled surrogate behind it; tests/fingerfem has it against full-order states."""

from dataclasses import replace

import numpy as np
import pytest

from rom import Answer, BackedSegment, Surrogate, TouchedSegment

QUANTITIES = "tip", "contact_force", "touch_distance"


@pytest.fixture(scope="module")
def backed() -> BackedSegment:
    touched, surrogate = TouchedSegment.load(), Surrogate.load()
    same = surrogate.scene | {"mesh": touched.scene["mesh"]}  # they are of two meshes, which matters to no sum here
    return BackedSegment(touched=touched, surrogate=replace(surrogate, scene=same))


@pytest.fixture(scope="module")
def points(backed) -> np.ndarray:
    lower, upper = backed.limits
    inner = lower + np.random.default_rng(0).random((500, 3)) * (upper - lower)
    return np.vstack([inner, [[30.0, 0.0, 10.0], [30.0, 0.0, np.inf], [300.0, 0.0, 0.01], [np.nan, 0.0, 0.01]]])


def sums(answer: Answer) -> dict[str, np.ndarray]:
    return {name: sum(part[name] for part in answer.error_parts.values()) for name in QUANTITIES}


def test_parts_of_the_error_sum_to_the_error_and_have_its_shapes(backed, points):
    answer = backed.evaluate(points)
    known, behind = backed.touched.evaluate(points), backed.surrogate.evaluate(points)
    assert 0.02 < np.mean(~known.inside) < 0.98
    for name in QUANTITIES:
        expected = np.where(known.inside, known.error[name], behind.error[name])
        assert answer.error[name] == pytest.approx(expected, rel=1e-12)
        assert np.array_equal(sums(answer)[name], answer.error[name]) and answer.error[name].shape == (len(points),)
        for of, part in answer.error_parts.items():
            for one, own in ((known, known.inside), (behind, ~known.inside)):
                values = one.error_parts.get(of, {}).get(name, np.zeros(len(points)))
                assert np.array_equal(part[name][own], values[own])
    assert set(answer.error_parts) == set(known.error_parts) | set(behind.error_parts)


def test_one_point_has_the_parts_that_it_has_among_many(backed, points):
    many, inside = backed.evaluate(points), backed.touched.evaluate(points).inside
    for k in [*np.flatnonzero(inside)[:5], *np.flatnonzero(~inside)[:5], *range(-4, 0)]:
        one = backed.evaluate(points[k])
        assert set(one.error_parts) <= set(many.error_parts)
        for name in QUANTITIES:
            assert np.shape(one.error[name]) == () and one.error[name] == many.error[name][k]
            assert sums(one)[name] == one.error[name]
            for part in one.error_parts.values():
                assert np.shape(part[name]) == ()


def test_neither_a_plane_too_far_away_nor_tensions_too_large_are_inside(backed, points):
    assert backed.evaluate(points[-4:]).inside.tolist() == [False, True, False, False]


def test_where_the_surrogate_answers_orientation_and_shortenings_are_not_known(backed, points):
    answer, known = backed.evaluate(points), backed.touched.evaluate(points)
    for values, error in (("orientation", "orientation_error"), ("shortenings", "shortening_error")):
        found = getattr(answer, values)
        assert np.array_equal(found[known.inside], getattr(known, values)[known.inside])
        assert np.isnan(found[~known.inside]).all() and np.isinf(getattr(answer, error)[~known.inside]).all()
    first = backed.evaluate(points[np.argmin(known.inside)])
    assert first.orientation.shape == (4,) and first.orientation_error == np.inf
