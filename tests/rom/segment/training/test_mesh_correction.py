"""A fit corrected by few states of a body that is a little softer: what they say of each other without one another."""

from dataclasses import replace

import numpy as np
import pytest

from rom.segment.training import mesh_correction, regression
from rom.segment.training.contact_error import relative_force_errors
from rom.segment.training.index_set import index_set
from rom.segment.training.mirrors import with_images
from tests.rom.rod import kirchhoff as rod

SOFTER = 1.04  # of all loads: what a stiff mesh leaves out


def softer(count: int, seed: int):
    """States of the rod under loads that count for more."""
    known = rod.states(count, seed)
    return replace(known, inputs=known.inputs / SOFTER, jacobians=known.jacobians * SOFTER)


def samples(states) -> regression.Samples:
    return regression.Samples.of(states, states.poses, states.jacobians)


def test_few_states_correct_a_fit_and_say_how_well(segment):
    few, held_out = softer(12, 5), softer(40, 6)
    powers = index_set(np.repeat([1.0, 1.25, 2.25], [2, 3, 3]), 3.0, 2, 4)
    known = {tuple(row) for row in segment.pose.powers.tolist()}
    powers = np.array([row for row in powers.tolist() if tuple(row) in known])
    both, predicted = regression.correction(segment.pose, samples(few), powers)
    alone, _ = regression.regression(samples(few), rod.BOX, powers)

    def errors(polynomial) -> float:
        return float(np.nanmedian(relative_force_errors(held_out, polynomial.value(held_out.inputs))))

    assert errors(both) < 0.1 * errors(segment.pose) and errors(both) < 0.1 * errors(alone)
    left_out = float(np.nanmedian(relative_force_errors(few, predicted)))
    assert 0.5 * errors(both) < left_out < 3 * errors(both)
    assert np.array_equal(both.powers, segment.pose.powers)  # no term more


@pytest.mark.parametrize("seed", [5, 7])
def test_few_distinct_tensions_support_few_products_of_tensions(segment, seed):
    """Wrenches at five tensions gave rows for 45 products: errors between the lines were 13 times the estimate."""
    few, held_out = softer(5, seed), softer(60, 99)
    states = with_images(few, rod.SCENE)
    found, predicted = mesh_correction.corrected_pose(segment.pose, (1.0, 1.25, 2.25), states)
    added = np.abs(found.coefficients - segment.pose.coefficients).max(axis=1) > 0
    alone = ~segment.pose.powers[:, 2:].any(axis=1)
    assert (added & alone).sum() <= states.tension_rows / 1.5 == 20
    errors = relative_force_errors(held_out, found.value(held_out.inputs))
    estimate = np.nanquantile(relative_force_errors(states, predicted), 0.95)
    assert np.nanquantile(errors, 0.95) < 2 * estimate
