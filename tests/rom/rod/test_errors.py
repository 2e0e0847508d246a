"""Estimated errors of rods: what variants of their elements change, in C as by fingers assembled from the variants."""

from dataclasses import replace

import numpy as np
import pytest

from rom import TouchedSegment
from rom.elements.fitting.calibration import force_deviations
from rom.elements.fitting.contact_error import relative_force_errors
from rom.elements.fitting.training import train
from rom.elements.law import POSE
from rom.elements.march import march
from rom.rod.objects.shapes import facing_plane
from rom.rod.rod import QUANTITIES, Rod
from tests.rom.elements import elastic_rod

SHARE = 1e-2  # of a variant's deviation, for differences
TWO = elastic_rod.in_series(0.040, 0.060)


def variant(finger: Rod, v: int, share: float) -> Rod:
    """A finger of elements that have moved by a share of the way to one of their variants."""

    def moved(law):
        coefficients = law.polynomial.coefficients.copy()
        own = law.deviations._by(law.polynomial.powers)[:, POSE * v : POSE * (v + 1)]
        coefficients[:, :POSE] += share * own
        return replace(law, polynomial=replace(law.polynomial, coefficients=coefficients))

    laws = {kind: moved(law) for kind, law in finger.elements.laws.items()}
    return replace(finger, elements=replace(finger.elements, laws=laws))


def before_plane(finger: Rod) -> TouchedSegment:
    return TouchedSegment(rod=finger, obstacle=facing_plane(elastic_rod.SIDE, (0.0, 0.1)))


def points(count: int, seed: int, deepest: float = 2e-3) -> np.ndarray:
    """Tensions and distances, half of them in contact, shape (count, 3)."""
    random = np.random.default_rng(seed)
    tensions = random.uniform([4.0, 0.0], [0.4 * elastic_rod.MOST_TENSION, 8.0], (count, 2))
    return np.column_stack([tensions, deepest * random.uniform(-1, 1, count)])


def near(model: TouchedSegment, given: np.ndarray) -> np.ndarray:
    """Points as far from where the finger touches as they say."""
    free = model.outputs(np.column_stack([given[:, :2], np.full(len(given), np.inf)]))
    return np.column_stack([given[:, :2], free[:, 4] + given[:, 2]])


@pytest.mark.parametrize("scene", [elastic_rod.scene(), elastic_rod.scene(0.083), TWO], ids=["one", "long", "two"])
def test_errors_are_what_fingers_of_the_variants_differ_by(finger, scene):
    """And a floor."""
    own = finger.assembled(scene)
    model, count = before_plane(own), finger.elements.laws["clamp"].deviations.coefficients.shape[1] // POSE
    at = near(model, points(40, 3))
    answers, out = model.evaluate(at), model.outputs(at)
    moved = np.array([before_plane(variant(own, v, SHARE)).outputs(at) - out for v in range(count)]) / SHARE
    slopes = np.array([model.jacobian(point)[3, 2] for point in at])
    floors, factor = own.errors.floors, own.elements.error_factor
    wanted = {
        "tip": np.sqrt(np.sum(moved[:, :, :3] ** 2, axis=(0, 2)) + 3 * floors.place**2),
        "contact_force": np.sqrt(
            np.sum(moved[:, :, 3] ** 2, axis=0) + (floors.force * out[:, 3]) ** 2 + (floors.place * slopes) ** 2
        ),
        "touch_distance": np.hypot(np.linalg.norm(moved[:, :, 4], axis=0), floors.place),
    }
    of_plates = answers.inside & (np.abs(out[:, 4] - at[:, 2]) > 1e-4)
    assert of_plates.sum() > 20 and (out[of_plates, 3] > 0).sum() > 8
    for name in QUANTITIES:
        estimated = answers.error[name][of_plates]
        np.testing.assert_allclose(estimated, factor(name) * wanted[name][of_plates], rtol=2e-2, atol=1e-12)


def test_estimates_cover_states_that_no_element_was_trained_on(finger):
    model = before_plane(finger)
    held_out = elastic_rod.states(30, 78)
    tensions = held_out.inputs[held_out.forces == 0, :2]
    free = np.column_stack([tensions, np.full(len(tensions), np.inf)])
    answers = model.evaluate(free)
    places = np.array([elastic_rod.plate(pair, np.zeros(6))[0] for pair in tensions])
    errors = np.linalg.norm(answers.tip + finger.rest - places, axis=1)
    assert np.mean(errors <= answers.error["tip"]) >= 0.93
    assert np.median(answers.error["tip"]) < 8 * np.median(errors)  # what 97 % of pressed states need as well


@pytest.mark.parametrize(("size", "modulus"), [(2.0, 1.0), (0.5, 10.0)])
def test_errors_of_a_similar_finger_are_similar(finger, size, modulus):
    scene, force = elastic_rod.similar(size, modulus), modulus * size**2
    one = before_plane(finger)
    obstacle = facing_plane(elastic_rod.SIDE * size, (0.0, 0.1 * size))
    other = TouchedSegment(rod=finger.assembled(scene), obstacle=obstacle)
    at = near(one, points(10, 4))
    small, large = one.evaluate(at), other.evaluate(at * [force, force, size])
    for name, unit in (("tip", size), ("contact_force", force), ("touch_distance", size)):
        np.testing.assert_allclose(large.error[name], unit * small.error[name], rtol=1e-3, atol=1e-12)


def test_a_longer_finger_has_larger_errors_as_they_act_with_a_lever(finger):
    tensions = np.array([[8.0, 3.0, np.inf]])
    errors = [
        before_plane(finger.assembled(elastic_rod.scene(length))).evaluate(tensions).error["tip"][0]
        for length in (0.040, 0.060, 0.090)
    ]
    assert 1.3 * errors[0] < errors[1] < errors[2] / 1.3


@pytest.mark.parametrize("lines", [5, 8])
def test_estimates_of_elements_of_few_lines_cover_other_states(lines):
    """Variants of what is left of few lines deviate far more than those of all: they must not scale estimates."""
    trained_on, held_out = elastic_rod.states(lines, 11), elastic_rod.states(20, 12)
    elements = train(trained_on, {})
    own = Rod(elements=elements, scene=trained_on.scene)
    t, pressed = held_out.tensions, held_out.forces > 0
    marched = march(own.segments[0].elements, held_out.inputs[:, :t], held_out.inputs[:, t:])
    inside = marched.inside.all(axis=1)
    off = np.linalg.norm(marched.plate[0] - held_out.plate.places, axis=1)
    moved = np.linalg.norm(marched.deviations[:, :3], axis=(1, 2))
    tips = elements.error_factor("tip") * np.hypot(moved, np.sqrt(3) * own.errors.floors.place)
    forces = relative_force_errors(held_out, *marched.plate)
    estimates = force_deviations(held_out, marched.deviations, own.errors.floors) * elements.error_factor(
        "contact_force"
    )
    some = inside & pressed
    assert inside.sum() > 30 and some.sum() > 20
    assert np.mean(off[inside] <= tips[inside]) >= 0.9 and np.mean(forces[some] <= estimates[some]) >= 0.9
