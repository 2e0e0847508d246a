"""Contacts felt from tensions and shortenings: right without noise, within their deviations with it, and honest."""

import copy
from dataclasses import replace

import numpy as np
import pytest
from assembled import in_series

from control.feel import KnownObjects, Noise, UnknownForce
from rom import AmongObjects, Rod
from rom.rod.compiled.reports import shortenings_by_force
from rom.rod.objects.shapes import facing_plane

NOISE = Noise(shortening=2e-5, tension=0.02, share=0.005)
QUIET = Noise(shortening=1e-8, tension=1e-6)
STATES = [([40.0, 5.0], 0.012), ([70.0, 20.0], 0.015), ([25.0, 0.0], 0.006)]  # tensions [N], d [m]
ALONE = {"force_z": (0.0, 0.0)}


def shorter(rod: Rod, tensions: list[float], position: float, force: list[float]) -> np.ndarray:
    return shortenings_by_force(rod.struct, np.array(tensions), position, np.array(force))[0]


@pytest.mark.parametrize(("tensions", "d"), STATES, ids=str)
@pytest.mark.parametrize("hint", [None, 1e-3], ids=["no hint", "near"])
def test_the_distance_and_force_of_exact_measurements_are_exact(model, tensions, d, hint):
    answer = model.evaluate([*tensions, d])
    felt = KnownObjects(model, QUIET).feel(tensions, answer.shortenings, hint=None if hint is None else [d + hint])
    assert felt.converged and felt.consistent and felt.freedom == 1 and felt.other is None and not len(felt.unseen)
    assert felt.values == pytest.approx([d], abs=1e-6)
    assert felt.contact_forces == pytest.approx([answer.contact_force], abs=1e-3)
    assert felt.tensions == pytest.approx(tensions, abs=1e-5)


def test_deviations_are_those_of_noisy_measurements(model):
    tensions, d = STATES[0]
    answer, random, sensed = model.evaluate([*tensions, d]), np.random.default_rng(1), KnownObjects(model, NOISE)
    pulled_by, shorter_by = NOISE.deviations(np.array(tensions), answer.shortening_error)
    found = [
        sensed.feel(
            tensions + pulled_by * random.standard_normal(2),
            answer.shortenings + shorter_by * random.standard_normal(2),
            hint=[d],
        )
        for _ in range(400)
    ]
    off = np.array([(one.values[0] - d) / one.deviations[0] for one in found])
    force = np.array([(one.contact_forces[0] - answer.contact_force) / one.force_deviations[0] for one in found])
    # a standard deviation of 400 samples has one of 3.5 %
    assert off.std() == pytest.approx(1.0, abs=0.12) and force.std() == pytest.approx(1.0, abs=0.12)
    assert abs(off.mean()) < 0.2 and abs(force.mean()) < 0.2
    assert np.mean([one.chi_square for one in found]) == pytest.approx(1.0, abs=0.25)  # one degree of freedom
    assert sum(not one.consistent for one in found) <= 12  # of 400, 1 % are expected


def test_forces_of_two_objects_are_felt_by_two_tendons(model):
    other = facing_plane(0.01, (0.0, 0.05))
    aside = replace(other, centre=(0.0, 0.0, 0.005), normal=(0.0, 0.0, -1.0), direction=(0.0, 0.0, 1.0))
    both = AmongObjects(rod=model.rod, obstacles=[other, aside])
    point = [40.0, 40.0, 0.008, 0.009]
    answer = both.evaluate(point)
    assert np.all(answer.contact_force > 0.1)
    felt = KnownObjects(both, QUIET).feel(point[:2], answer.shortenings, hint=[0.009, 0.008])
    assert felt.converged and felt.freedom == 0
    assert felt.values == pytest.approx(point[2:], abs=2e-6)
    assert felt.contact_forces == pytest.approx(answer.contact_force, abs=2e-3)


def test_a_force_at_a_known_position_is_exact(model):
    measured = shorter(model.rod, [40.0, 5.0], 0.033, [-2.0, 0.5])
    felt = UnknownForce(model.rod, QUIET).feel([40.0, 5.0], measured, {"position": (0.033, 0.0)})
    assert felt.converged and not len(felt.unseen) and felt.freedom == 0
    assert felt.values == pytest.approx([0.033, -2.0, 0.5], abs=1e-4)
    assert felt.deviations[0] == 0.0


def test_two_tendons_to_one_plate_do_not_see_where_a_force_presses(model):
    """They see how far their plate has turned: a larger force nearer to the clamp turns it as far."""
    measured = shorter(model.rod, [40.0, 5.0], 0.033, [-2.0, 0.0])
    felt = UnknownForce(model.rod, NOISE, most=10.0).feel([40.0, 5.0], measured, ALONE)
    assert felt.converged and felt.consistent and len(felt.unseen) == 1
    (name,) = felt.unseen_names
    assert "position" in name and "force_y" in name and "force_z" not in name
    assert abs(felt.values[0] - 0.033) < 3 * felt.deviations[0] and abs(felt.values[1] + 2.0) < 3 * felt.deviations[1]


def test_tendons_to_two_plates_see_where_a_force_presses(model):
    """Along both axes: each tendon sees the turn of its own plate, whose ratio is that of the moments' integrals."""
    two = in_series(model.rod, 2)
    tendons = [one | {"segment": 2 - k} for k, one in enumerate(two.scene["tendons"])]
    rod = two.assembled(two.scene | {"tendons": tendons})
    tensions, force = [12.0, 4.0], [-0.4, -0.3]
    felt = UnknownForce(rod, Noise(shortening=1e-6, tension=1e-3), most=2.0).feel(
        tensions, shorter(rod, tensions, 0.08, force), {"position": (0.075, 0.01)}
    )
    assert felt.converged and felt.consistent
    assert np.all(np.abs(felt.values - [0.08, *force]) < 3 * felt.deviations + 1e-6)


def test_without_a_force_its_position_is_not_seen(model):
    felt = UnknownForce(model.rod, NOISE).feel([40.0, 5.0], model.rod.shortening([40.0, 5.0]), ALONE)
    assert felt.converged and len(felt.unseen) >= 1 and "position" in " ".join(felt.unseen_names)


def test_an_object_that_does_not_touch_is_not_seen(model):
    tensions = [10.0, 5.0]
    free = model.evaluate([*tensions, np.inf])
    felt = KnownObjects(model, NOISE).feel(tensions, free.shortenings)
    assert felt.converged and felt.contact_forces[0] < 3 * felt.force_deviations[0] + 0.05
    assert felt.values[0] > free.touch_distance - 1e-3


def test_a_force_that_no_plane_explains_is_inconsistent(model):
    measured = shorter(model.rod, [40.0, 5.0], 0.045, [-1.0, -1.0])
    assert not KnownObjects(model, NOISE).feel([40.0, 5.0], measured).consistent


def test_what_is_expected_moves_the_estimate_by_its_weight(model):
    tensions, d = STATES[0]
    measured, sensed = model.evaluate([*tensions, d]).shortenings, KnownObjects(model, NOISE)
    alone = sensed.feel(tensions, measured, hint=[d])
    deviation = float(alone.deviations[0])
    both = sensed.feel(tensions, measured, {"d": (d + 2 * deviation, deviation)}, hint=[d])
    assert both.deviations[0] == pytest.approx(deviation / np.sqrt(2), rel=0.02)
    assert both.values[0] - alone.values[0] == pytest.approx(deviation, rel=0.05)


@pytest.mark.parametrize("bad", [[np.nan, 0.001], [0.002, np.inf]], ids=str)
def test_measurements_that_are_no_numbers_are_refused(model, bad):
    felt = KnownObjects(model, NOISE).feel([40.0, 5.0], bad)
    assert felt.status == "out_of_domain" and "shortenings must be finite" in felt.reason and np.isnan(felt.values[0])
    felt = KnownObjects(model, NOISE).feel([400.0, 5.0], [0.001, 0.001])
    assert felt.status == "out_of_domain" and felt.reason.startswith("tensions must be from")


def test_wrong_arguments_are_refused(model):
    sensed = KnownObjects(model, NOISE)
    for call, said in (
        (lambda: sensed.feel([40.0], [0.001, 0.001]), "shape"),
        (
            lambda: sensed.feel([40.0, 5.0], [0.001, 0.001], {"distance": (0.01, 0.0)}),
            "expected must name d, got distance",
        ),
        (lambda: sensed.feel([40.0, 5.0], [0.001, 0.001], {"d": (1.0, 0.0)}), "expected d must be from"),
        (lambda: sensed.feel([40.0, 5.0], [0.001, 0.001], hint=[0.01, 0.01]), "hint must be d"),
        (
            lambda: KnownObjects(model, Noise(shortening=0.0, tension=0.0)).feel([40.0, 5.0], [0.001, 0.001]),
            "above 0 N",
        ),
    ):
        with pytest.raises(ValueError, match=said):
            call()


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy])
def test_copies_feel_alike(model, copied):
    tensions, d = STATES[0]
    measured = model.evaluate([*tensions, d]).shortenings
    for one in (KnownObjects(model, NOISE), UnknownForce(model.rod, NOISE)):
        assert np.array_equal(copied(one).feel(tensions, measured).values, one.feel(tensions, measured).values)


def test_a_finger_with_chambers_is_refused(chambered):
    with pytest.raises(ValueError, match="must be of a finger with tendons alone, got one with 2 chambers"):
        UnknownForce(chambered, NOISE).feel([1.0, 0.0, 0.0], [0.0, 0.0, 0.0])
