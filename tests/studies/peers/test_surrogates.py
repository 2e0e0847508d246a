"""Other surrogates are given the same states, and judged alike."""

import numpy as np
import pytest
from scipy.interpolate import RBFInterpolator

from studies.peers.surrogates.judging import errors, query_times
from studies.peers.surrogates.learning import AFAR, WAYS, Fitted, everywhere, learned, with_touch
from studies.peers.surrogates.states import HeldOut, States

STIFFNESS = 400.0  # [N/m]


def reach(tensions: np.ndarray) -> np.ndarray:
    """Of a finger that bends in proportion to its tensions [m]."""
    return 2e-4 * tensions[:, 0] + 5e-5 * tensions[:, 1]


def tip_of(points: np.ndarray) -> np.ndarray:
    """It moves along y up to the plane."""
    way = np.minimum(reach(points), points[:, -1])
    return np.column_stack([-0.1 * way, way, 0 * way])


def force_of(points: np.ndarray) -> np.ndarray:
    """Grows with the way that the plane takes from it [N]."""
    return STIFFNESS * np.maximum(reach(points) - points[:, -1], 0.0)


@pytest.fixture
def states() -> States:
    """Lines of states as a training set has them: tensions, then planes from touch to the nearest."""
    lower, upper = np.array([0.0, 0.0, 0.001]), np.array([100.0, 100.0, 0.031])
    tensions = 100 * np.random.default_rng(0).random((30, 2))
    touched = reach(tensions)
    lines = [np.column_stack([np.tile(one, (6, 1)), np.linspace(d, 0.001, 8)[1:7]])
             for one, d in zip(tensions, touched, strict=True) if d > 0.002]  # fmt: skip
    points = np.concatenate(lines)
    free = tip_of(np.column_stack([tensions, np.full(len(tensions), np.inf)]))
    return States(
        tensions=tensions,
        free_tip=free,
        touch_distance=touched,
        parameters=points,
        reach=reach(points),
        tip=tip_of(points),
        force=force_of(points),
        lower=lower,
        upper=upper,
    )


def splines(inputs: np.ndarray, outputs: np.ndarray, lines: np.ndarray) -> Fitted:
    return Fitted(RBFInterpolator(inputs, outputs), outputs.nbytes, f"{lines.max() + 1} lines")


def random_states(states: States) -> HeldOut:
    points = states.lower + np.random.default_rng(1).random((60, 3)) * (states.upper - states.lower)
    return HeldOut(parameters=points, tip=tip_of(points), force=force_of(points))


def test_states_are_read_as_they_were_written(states, tmp_path):
    states.save(tmp_path / "states.npz")
    found = States.load(tmp_path / "states.npz")
    assert found.count == states.count and np.array_equal(found.force, states.force)


def test_free_states_stand_for_planes_that_they_do_not_touch(states):
    places, outputs = everywhere(states)
    free = places[len(states.parameters) :]
    assert len(free) == AFAR * len(states.tensions) and np.all(outputs[len(states.parameters) :, 3] == 0)
    assert np.all(free[:, -1] >= np.minimum(reach(free), states.upper[-1]) - 1e-12)


def test_states_of_touch_have_no_force_and_the_free_tip(states):
    found = with_touch(states)
    added = found.parameters[len(states.parameters) :]
    assert len(added) == np.sum(states.touch_distance > 0.001)
    assert np.allclose(reach(added), added[:, -1]) and np.all(found.force[len(states.parameters) :] == 0)


@pytest.mark.parametrize("way", WAYS)
def test_every_way_learns_tip_and_force_and_never_pulls(states, way):
    model, held_out = WAYS[way](splines, states), random_states(states)
    told = np.array([model.ask(point) for point in held_out.parameters])
    found = errors(told, held_out)
    assert told.shape == (60, 4) and told[:, 3].min() >= 0
    assert found["contact_force"]["median"] < 0.05 and found["tip"]["median"] < 0.05


def test_states_of_one_line_share_a_number():
    seen = []

    def method(inputs: np.ndarray, outputs: np.ndarray, lines: np.ndarray) -> Fitted:
        seen.append(lines.tolist())
        return splines(inputs, outputs, lines)

    tensions = np.array([[1.0, 2.0], [3.0, 4.0], [1.0, 2.0], [5.0, 1.0], [3.0, 4.0]])
    places = np.column_stack([tensions, np.arange(5.0)])
    learned(method, places, np.arange(5.0)[:, None] ** 2, tensions)
    first, second, third, fourth, fifth = seen[0]
    assert first == third and second == fifth and len({first, second, fourth}) == 3


def test_touch_is_decided_by_the_free_states_and_better_than_by_one_model(states):
    held_out = random_states(states)
    wrong = {}
    for way, learn in WAYS.items():
        told = np.array([learn(splines, states).ask(point) for point in held_out.parameters])
        wrong[way] = errors(told, held_out)["touch"]["wrong"]
    one, both, aligned = wrong.values()
    assert both == aligned == 0.0 and one > 0


def test_errors_are_relative_to_the_true_force_and_the_true_way():
    true = HeldOut(
        parameters=np.zeros((4, 3)), tip=np.array([[0.0, 0.01, 0.0]] * 4), force=np.array([0.0, 0.05, 1.0, 2.0])
    )
    told = np.column_stack([true.tip + np.array([0.0, 0.001, 0.0]), [0.2, 0.0, 1.1, 0.0]])
    found = errors(told, true)
    assert found["contact_force"] == pytest.approx({"median": 0.55, "p95": 0.955, "max": 1.0})
    assert found["tip"]["max"] == pytest.approx(0.1) and found["tip_distance"]["max"] == pytest.approx(0.001)
    # The second state, of less than 0.1 N, is neither free nor felt.
    assert found["touch"] == {"wrong": pytest.approx(2 / 3), "without_touch": 1, "missed": 1, "free": 1, "felt": 2}


def test_times_of_queries_are_of_single_points():
    asked = []
    found = query_times(lambda point: asked.append(point.shape), np.zeros((5, 3)))
    assert set(asked) == {(3,)} and 0 <= found["p50_us"] <= found["p99_us"] and found["seconds"] > 0
