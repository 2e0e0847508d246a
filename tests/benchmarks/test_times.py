"""Times of queries, contacts, holds and Newton iterations: `make bench` compares them with an earlier commit's."""

import numpy as np
import pytest

import rom
from control import Finger
from control.feel import KnownObjects, Noise
from fingerfem import FingerModel, load_scene

SCENES = "scenes/draft.toml", "scenes/one_segment.toml"


@pytest.fixture(scope="module")
def finger():
    return Finger(rom.load())


def test_query_with_its_jacobian(benchmark, finger):
    value, jacobian = benchmark(finger.model.value_and_jacobian, np.array([50.0, 20.0, 0.012]))
    assert np.isfinite(value).all() and np.isfinite(jacobian).all()


def test_contact_from_python(benchmark, finger):
    answer = benchmark(finger.model.evaluate, [50.0, 20.0], d=0.012)
    assert answer.inside and answer.contact_force > 1.0


def test_increment_with_friction_in_guides(benchmark, finger):
    guided = rom.GuidedFinger(model=finger.model, friction=0.2)
    tensions = iter(np.resize([40.0, 40.1, 40.2, 40.1], 1_000_000))
    assert benchmark(lambda: guided.advance([next(tensions), 10.0, 0.05])).status == "converged"


def test_hold(benchmark, finger):
    assert benchmark(finger.hold, 1.0, 0.012, start=[50.0, 10.0]).converged


def test_feel(benchmark, finger):
    sensed = KnownObjects(finger.model, Noise(shortening=2e-5, tension=0.05, share=0.005))
    shortenings = finger.model.evaluate([50.0, 10.0, 0.012]).shortenings
    felt = benchmark(sensed.feel, [50.0, 10.0], shortenings, hint=[0.0122])
    assert felt.converged and felt.values[0] == pytest.approx(0.012, abs=1e-5)


def test_table(benchmark, finger):
    points = np.random.default_rng(0).uniform(*finger.model.limits, size=(10_000, 3))
    assert benchmark(rom.specialise(finger.model, 8).outputs, points).shape[0] == len(points)


@pytest.mark.parametrize("scene", SCENES)
def test_newton_iteration(benchmark, scene):
    """Residual, tangent, factorisation and solve of a bent finger."""
    model = FingerModel(load_scene(scene))
    model.solve([50.0, 20.0], sensitivities=False)
    newton, problem = model.continuation.newton, model.problem

    def iteration():
        right, _ = problem.residual()
        return newton.linearise().solve(right)

    assert np.isfinite(benchmark.pedantic(iteration, rounds=5, warmup_rounds=1).norm())
