"""Jumps between random loads end in an equilibrium or a reason; the equilibrium does not depend on the path."""

import numpy as np
import pytest
from farm import ROOT

from fingerfem import FingerModel, LoadNotReached, load_scene
from fingerfem.equilibrium.continuation import Continuation, StepOptions
from fingerfem.equilibrium.failures import NotConverged
from fingerfem.scene.laws import neo_hookean_from
from fingerfem.scene.scene import Scene

LENGTH, NEAREST, FARTHEST = 0.050, 0.001, 0.031  # [m]
INCOMPRESSIBLE = neo_hookean_from(9.88e6, 0.4999)


def small(mixed: bool = False) -> FingerModel:
    """Half of the draft finger on few cells, with tendons on both sides."""
    table = load_scene(ROOT / "scenes" / "draft.toml").model_dump()
    table["mesh"]["cells"] = [9, 5]
    sides = {"F1": 0.004, "F3": -0.004}
    table["tendons"] = [table["tendons"][0] | {"name": name, "offset": [y, 0.0]} for name, y in sides.items()]
    if mixed:
        table["material"] = {"law": "neo-hookean", "C1": INCOMPRESSIBLE.C1, "D1": INCOMPRESSIBLE.D1}
    return FingerModel(Scene.model_validate(table))


@pytest.fixture(scope="module")
def model() -> FingerModel:
    return small()


def residual(model: FingerModel) -> float:
    """2-norm of the residual over the force scale [-]."""
    b, _ = model.problem.residual()
    norm = b.norm() / model.problem.force_scale
    b.destroy()
    return norm


def check_equilibrium(model: FingerModel) -> None:
    assert np.isfinite(model.problem.displacement).all()
    assert residual(model) <= 1e-8
    assert model.problem.smallest_volume_ratio() > 0


@pytest.mark.long
@pytest.mark.parametrize(("jumps", "mixed"), [(20, False), (10, True), (500, False), (500, True)])
def test_full_newton_steps_between_random_loads_converge_or_give_a_reason(jumps, mixed):
    """Each jump is tried as one step first, then by continuation; neither leaves a NaN behind."""
    model, draw = small(mixed), np.random.default_rng(38)
    continuation, outcomes = model.continuation, {"full step": 0, "continuation": 0, "refused": 0}
    continuation.advance([0.0, 0.0], FARTHEST)
    for _ in range(jumps):
        tensions, distance = draw.uniform(0, [100.0, 100.0]), draw.uniform(NEAREST, FARTHEST)
        before = model.problem.displacement.copy()
        model.problem.set_loads(tensions, distance)
        try:
            continuation.newton.solve("plain")
            check_equilibrium(model)
            outcomes["full step"] += 1
        except NotConverged as failure:
            assert failure.reason
            assert np.array_equal(model.problem.displacement, before)
        continuation.start(continuation.tensions, continuation.distance, before)
        try:
            continuation.advance(tensions, distance)
            assert np.array_equal(continuation.tensions, tensions)
            assert continuation.distance == distance
            outcomes["continuation"] += 1
        except LoadNotReached as failure:
            assert failure.reason
            assert np.array_equal(continuation.tensions, failure.tensions)
            outcomes["refused"] += 1
        check_equilibrium(model)
    assert outcomes["continuation"] + outcomes["refused"] == jumps
    assert outcomes["continuation"] >= 0.98 * jumps
    assert outcomes["full step"] < jumps  # some full steps do fail here: the refusal is tested too


TARGETS = [([60.0, 0.0], 0.010), ([90.0, 20.0], 0.020), ([40.0, 10.0], 0.005)]


def reached_by(model: FingerModel, options: StepOptions, path: list) -> np.ndarray:
    """Displacement at the end of a path of loads from rest [m]."""
    continuation = Continuation(model.problem, options)
    for tensions, distance in path:
        continuation.advance(tensions, distance)
    return model.problem.displacement.copy()


@pytest.mark.parametrize(
    "target", [TARGETS[0], *(pytest.param(one, marks=pytest.mark.long) for one in TARGETS[1:])], ids=str
)
def test_the_equilibrium_depends_neither_on_the_number_of_steps_nor_on_the_path(model, target):
    """Few and many steps, and three random detours with the obstacle in place, to a ten millionth of the length."""
    tensions, distance = target
    direct = reached_by(model, StepOptions(), [(tensions, None), target])
    ways = [
        (StepOptions(turn=0.1, first_turn=0.1, approach=0.02), [(tensions, None), target]),
        (StepOptions(turn=3.0, first_turn=3.0, approach=1.0), [(tensions, None), target]),
        (StepOptions(), [([0.0, 0.0], distance), target]),
    ]
    draw = np.random.default_rng(7)
    for _ in range(3):
        detour = [(draw.uniform(0, 100, 2), draw.uniform(NEAREST, FARTHEST)) for _ in range(2)]
        ways.append((StepOptions(), [*detour, target]))
    for options, path in ways:
        assert np.abs(reached_by(model, options, path) - direct).max() < 1e-7 * LENGTH


def test_the_finger_comes_back_to_its_rest_position(model):
    """Wherever it was, without loads and contact it is straight."""
    path = [([100.0, 0.0], 0.020), ([20.0, 80.0], 0.002), ([0.0, 0.0], FARTHEST)]
    assert np.abs(reached_by(model, StepOptions(), path)).max() < 1e-9 * LENGTH
    assert model.problem.contact.force() == 0.0
