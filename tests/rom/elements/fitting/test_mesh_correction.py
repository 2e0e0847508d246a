"""A finer mesh corrects elements by few states; estimates are scaled by what was left out of both."""

from dataclasses import replace

import numpy as np
import pytest

from rom.elements.fitting import training
from rom.elements.fitting.calibration import COVERED, conformal
from rom.elements.fitting.mesh_correction import Differences
from rom.elements.samples import section_states
from rom.elements.samples.section_states import Bodies, SectionStates
from rom.rod.rod import Rod
from tests.rom.elements import elastic_rod

SOFTER = 0.99  # modulus of the finer mesh's rubber, over that of the training


def softer(states: SectionStates) -> SectionStates:
    """States of a rod of softer rubber: those of the rod under loads larger by as much."""

    def moved(bodies: Bodies) -> Bodies:
        return replace(bodies, motions=bodies.motions / SOFTER)

    return replace(
        states,
        inputs=states.inputs * SOFTER,
        sections=moved(states.sections),
        plate=moved(states.plate),
        shortening_changes=states.shortening_changes / SOFTER,
        corner_changes=states.corner_changes / SOFTER,
    )


@pytest.fixture(scope="module")
def corrected(rod_states) -> Rod:
    found = training.train(rod_states, {}, finer=softer(elastic_rod.states(8, 5)))
    return Rod(elements=found, scene=elastic_rod.scene())


def test_states_of_a_finer_mesh_are_predicted_that_no_element_has_seen(finger, corrected):
    held_out = softer(elastic_rod.states(10, 77))
    before, after = (
        np.linalg.norm(elastic_rod.placed(one, held_out.inputs)[0] - held_out.plate.places, axis=1)
        for one in (finger, corrected)
    )
    assert np.median(after) < 0.1 * np.median(before) and after.max() < 0.3 * before.max()


@pytest.mark.parametrize("left_out", [[], [1]])
def test_a_share_of_a_law_is_found_from_a_few_samples_and_holds_where_there_are_none(finger, left_out):
    """Two of them near the axes' middle, and the law's value at rest is no part of it."""
    law, random = finger.elements.laws["clamp"], np.random.default_rng(4)
    own, middle = law.polynomial, (law.polynomial.lower + law.polynomial.upper) / 2
    points = middle + 0.1 * random.uniform(-1, 1, (4, len(middle))) * (own.upper - own.lower)
    at_rest = own.value(np.zeros((1, len(middle))))
    shares = np.linspace(-0.02, 0.03, at_rest.size)
    values, gradient = own.value_and_gradient(points)
    equations = Differences(law, own.powers[own.powers.sum(axis=1) <= 1], 2)
    equations.prior[:] = 1.0
    equations.add(points, shares * (values - at_rest), shares[:, None] * gradient, np.array([0, 1, 0, 1]))
    everywhere = own.lower + random.uniform(0, 1, (20, len(middle))) * (own.upper - own.lower)
    found = equations.fit(np.arange(len(equations.powers)), left_out).value(everywhere)
    scale = np.abs(own.value(everywhere)).max(axis=0)
    assert not law.has_lengths
    off = np.abs(found - shares * (own.value(everywhere) - at_rest)).max(axis=0)
    assert off == pytest.approx(0, abs=1e-9 * scale.max())


def test_the_correction_is_part_of_the_estimated_error(finger, corrected):
    """As one more variant of every law."""
    for kind, law in corrected.elements.laws.items():
        own = finger.elements.laws[kind].deviations.coefficients
        assert law.deviations.coefficients.shape == (len(own), own.shape[1] + 6)
        assert np.abs(law.deviations.coefficients[:, -6:]).max() > 0


def test_the_factor_of_an_estimate_covers_a_further_state_with_the_probability_that_is_meant():
    random, covered = np.random.default_rng(3), []
    for _ in range(2000):
        known, further = np.split(np.abs(random.standard_normal(61)), [60])
        covered.append(further[0] <= conformal(known))
    assert COVERED - 0.01 < np.mean(covered) < 1.0
    assert conformal(np.array([1.0, 3.0, 2.0])) == 3.0


def test_cross_sections_between_those_of_a_mesh_are_interpolated():
    own, at = np.linspace(0, 0.049, 24), np.linspace(0, 0.049, 32)
    values = np.stack([np.sin(40 * own), own**5], axis=1)
    found = section_states._between(own, at) @ values
    assert found == pytest.approx(np.stack([np.sin(40 * at), at**5], axis=1), abs=2e-6)
    np.testing.assert_array_equal(section_states._between(own, own), np.eye(24))
