"""One-dimensional functions of three kinds through the same terms, and the choice among them."""

import numpy as np
import pytest

from rom.functions import chosen, of_kind
from rom.held_out import check
from rom.separation import hermite


def test_the_kind_that_errs_least_on_held_out_states_is_chosen(surrogate, held_out):
    errors = {kind: check(of_kind(surrogate, kind), held_out)["contact_force"]["p95"] for kind in hermite.KINDS}
    best = min(errors, key=errors.get)
    assert chosen(surrogate, held_out).free.kind == best
    assert (
        errors["linear"] > 1.5 * errors[best]
    )  # it errs with the square of the nodes' distance, the others with its fourth


@pytest.mark.parametrize("kind", hermite.KINDS)
def test_all_kinds_agree_at_the_nodes(surrogate, kind):
    form, other = surrogate.free, surrogate.free.of_kind(kind)
    at = np.array([form.nodes[0][3], form.nodes[1][5]])
    assert other.value(at) == pytest.approx(form.value(at), rel=1e-12, abs=1e-15)


def test_a_spline_is_the_hermite_function_of_its_slopes(surrogate):
    spline = surrogate.free.of_kind("cubic")
    points = np.random.default_rng(0).random((50, 2)) * 100
    for point in points:
        assert spline.of_kind("hermite").value(point) == pytest.approx(spline.value(point), rel=1e-10, abs=1e-14)
