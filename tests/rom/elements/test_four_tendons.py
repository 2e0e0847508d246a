"""Elements with more tendons than resultants."""

import numpy as np
import pytest

from rom.elements.fitting import candidates, degrees, training
from rom.elements.fitting.candidates import candidates as laws_of
from rom.elements.polynomial import Polynomial
from rom.elements.samples.element_samples import Samples
from rom.rod.rod import Rod
from tests.rom.elements import elastic_rod
from tests.rom.elements.laws import total_degree

T = 4


@pytest.fixture(scope="module")
def elements():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(degrees, "HIGHEST", 4.0)
        patch.setattr(training, "HIGHEST", 4.0)
        return training.train(elastic_rod.states(24, 0, offsets=elastic_rod.FOUR), {})


@pytest.fixture(scope="module")
def finger(elements):
    return Rod(elements=elements, scene=elements.scene)


def test_a_law_of_full_degree_is_the_polynomial_of_the_tensions_themselves(monkeypatch):
    """Combinations of tensions span the same polynomials; ranges of four sizes leave the section without a mirror."""
    for name, weights in (("BY_ORDER", (1.0, 1.0, 1.0)), ("HIGHER", 1.0), ("WRENCH", (1.0, 1.0))):
        monkeypatch.setattr(candidates, name, weights)
    scene, random = elastic_rod.scene(offsets=elastic_rod.FOUR), np.random.default_rng(4)
    for k, tendon in enumerate(scene["tendons"]):
        tendon["tension"] = [0.0, 40.0 - k]
    powers = total_degree(T + 6, 2)
    box = np.array([[0.0] * T + [-1.0] * 6, [40.0] * T + [1.0] * 6])
    wanted = Polynomial(
        lower=box[0], upper=box[1], powers=powers, coefficients=random.normal(size=(len(powers), 6 + T))
    )
    inputs = random.uniform(*box, (80, T + 6))
    values, jacobians = wanted.value_and_gradient(inputs)
    samples = Samples(inputs=inputs, values=values, jacobians=jacobians, lines=np.arange(80), length=0.01)
    found = laws_of([samples], dict.fromkeys(range(80), 0), scene, [], 2.0).law(2.0).of_length(0.01)
    assert not np.array_equal(found.tension_map, np.eye(T))
    others = random.uniform(0.9 * box[0], 0.9 * box[1], (20, T + 6))
    values, jacobians = wanted.value_and_gradient(others)
    own_values, own_jacobians = found.value_and_gradient(others)
    np.testing.assert_allclose(own_values, values, atol=1e-7)
    np.testing.assert_allclose(own_jacobians, jacobians, atol=1e-7)


def test_a_finger_with_four_tendons_predicts_held_out_states(elements, finger):
    held_out = elastic_rod.states(10, 77, offsets=elastic_rod.FOUR)
    left_out = elements.provenance["left_out"]["place_m"]
    centres, _, _ = elastic_rod.placed(finger, held_out.inputs)
    off = np.linalg.norm(centres - held_out.plate.places, axis=1)
    assert np.median(off) < 2 * left_out["median"] and np.quantile(off, 0.95) < 2 * left_out["p95"]
    assert np.median(off) < 1e-3 * np.median(np.linalg.norm(held_out.plate.places - finger.rest, axis=1))


def test_a_similar_finger_read_from_its_file_is_similar(finger, tmp_path):
    size, modulus = 3.0, 0.1
    force, scene = modulus * size**2, elastic_rod.scene(0.050 * size, size * elastic_rod.FOUR)
    scene["geometry"] |= {"side": size * elastic_rod.SIDE, "plate": size * elastic_rod.PLATE}
    material = scene["material"]
    scene["material"] = material | {"C1": material["C1"] * modulus, "D1": material["D1"] / modulus}
    for tendon in scene["tendons"]:
        tendon["tension"] = [0.0, force * elastic_rod.MOST_TENSION]
    finger.assembled(scene).save(tmp_path / "finger.h5")
    other, inputs = Rod.load(tmp_path / "finger.h5"), elastic_rod.pressed(4, 9, elastic_rod.FOUR)
    centres, _, inside = elastic_rod.placed(finger, inputs)
    larger, _, also = elastic_rod.placed(other, inputs * np.repeat([force, force * size], [T + 3, 3]))
    np.testing.assert_allclose(larger, size * centres, rtol=0, atol=1e-12 * size)
    np.testing.assert_array_equal(inside, also)


def test_a_degree_of_more_products_than_a_regression_may_have_is_not_tried(monkeypatch):
    states = elastic_rod.states(4, 0, offsets=elastic_rod.FOUR)
    monkeypatch.setattr(candidates, "MOST", 100)
    for one in training.prepare(states).kinds.values():
        assert len(one.equations.powers) <= 100 and one.highest < degrees.HIGHEST
        assert one.supports(one.highest) and not one.supports(one.highest + candidates.STEP)
