"""Equilibria of the draft finger: balances, identities of the potential, derivatives, limits, independence of path."""

import re

import numpy as np
import pytest

from fingerfem import FingerModel, LoadNotReached
from fingerfem.equilibrium.continuation import Continuation, StepOptions
from fingerfem.equilibrium.failures import NotConverged
from fingerfem.equilibrium.newton import Newton, NewtonOptions
from fingerfem.scene.scene import Scene

LOADS = [([50.0, 0.0], 0.005), ([60.0, 40.0], 0.010), ([100.0, 30.0], 0.020)]


@pytest.fixture(scope="module")
def states(draft):
    return {(tuple(tensions), d): draft.solve(tensions, d) for tensions, d in LOADS}


def test_residual_is_the_derivative_of_the_energy_and_the_tangent_that_of_the_residual(draft):
    """Taylor: both remainders fall with the square of the step (in contact, plates and tendons included)."""
    draft.solve([50.0, 20.0], 0.005, sensitivities=False)
    u = draft.problem.fields.u.x.array
    x = draft.problem.space.tabulate_dof_coordinates()
    # A smooth direction that vanishes at the clamp and does not stretch the plate out of all proportion.
    direction = (1e-3 * np.column_stack([x[:, 0], x[:, 0] ** 2 / 0.05, -x[:, 0]])).ravel()
    draft.problem.displacement[:] += 0.3 * direction
    at = u.copy()
    draft.problem.extrapolate_stress()

    def energy():
        return draft.problem.energy()

    def residual():
        b, _ = draft.problem.residual()
        values = b.array_r.copy()
        b.destroy()
        return values

    e0, r0 = energy(), residual()
    slope = r0 @ direction
    K = draft.problem.tangent()
    p = K.createVecRight()
    p.array[:] = direction
    Kp = K.createVecLeft()
    K.mult(p, Kp)
    free = np.abs(direction) > 0
    remainders = []
    for h in (1e-3, 5e-4):
        u[:] = at + h * direction
        remainders.append((abs(energy() - e0 - h * slope), np.linalg.norm((residual() - r0 - h * Kp.array_r)[free])))
    u[:] = at
    (e1, r1), (e2, r2) = remainders
    assert e1 / e2 == pytest.approx(4.0, rel=0.05)
    assert r1 / r2 == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize("load", [LOADS[0], *(pytest.param(one, marks=pytest.mark.long) for one in LOADS[1:])], ids=str)
def test_forces_and_shortenings_are_derivatives_of_the_potential(draft, states, load):
    (tensions, d), state = load, states[tuple(load[0]), load[1]]
    h = 1e-5
    ahead, behind = (draft.solve(tensions, d + step, sensitivities=False).energy for step in (h, -h))
    assert -(ahead - behind) / (2 * h) == pytest.approx(state.contact_force, rel=1e-3)
    for k, name in enumerate(("F1", "F2")):
        if not 0 < tensions[k] < 100:
            continue
        step = np.eye(2)[k] * 0.1
        ahead, behind = (draft.solve(tensions + sign * step, d, sensitivities=False).energy for sign in (1, -1))
        length = 0.049 - state.channel_shortening[name]
        assert (ahead - behind) / 0.2 == pytest.approx(length, rel=1e-5)


@pytest.mark.parametrize("load", [LOADS[0], pytest.param(LOADS[1], marks=pytest.mark.long)], ids=str)
def test_sensitivities_are_differences_of_states(draft, states, load):
    (tensions, d), state = load, states[tuple(load[0]), load[1]]
    for name, change, h in (("F1", ([1.0, 0.0], 0.0), 0.01), ("d", ([0.0, 0.0], 1.0), 1e-6)):
        sides = [
            draft.solve(np.add(tensions, sign * h * np.array(change[0])), d + sign * h * change[1], sensitivities=False)
            for sign in (1, -1)
        ]
        force = (sides[0].contact_force - sides[1].contact_force) / (2 * h)
        tip = (sides[0].tip - sides[1].tip) / (2 * h)
        assert state.sensitivities["contact_force"][name] == pytest.approx(force, rel=2e-3)
        assert state.sensitivities["tip"][name] == pytest.approx(tip, rel=2e-3, abs=1e-3 * np.abs(tip).max())


def test_sensitivities_are_reciprocal(states):
    """Maxwell: dL_1/dF_2 = dL_2/dF_1 and dN/dF = d(shortening)/dd, for all are derivatives of one potential."""
    state = states[(60.0, 40.0), 0.010]
    shortening, force = state.sensitivities["channel_shortening"], state.sensitivities["contact_force"]
    assert shortening["F1"]["F2"] == pytest.approx(shortening["F2"]["F1"], rel=1e-6)
    for name in ("F1", "F2"):
        assert shortening["d"][name] == pytest.approx(force[name], rel=1e-6)


def test_all_newton_strategies_find_the_same_state_and_the_mixed_one_sooner(draft):
    counts, found = {}, {}
    for strategy in ("mixed", "plain", "line search"):
        newton = Newton(draft.problem, NewtonOptions(iterations=40))
        draft.continuation.rest()
        draft.problem.set_loads([20.0, 0.0], None)
        counts[strategy], _ = newton.solve(strategy)
        found[strategy] = draft.problem.displacement.copy()
    for other in ("plain", "line search"):
        assert np.abs(found["mixed"] - found[other]).max() < 1e-9 * 0.05
        assert counts["mixed"] < counts[other]


def test_touch_begins_exactly_at_the_touch_distance(draft):
    touch = draft.solve([50.0, 0.0], sensitivities=False).touch_distance
    assert draft.solve([50.0, 0.0], touch + 1e-7, sensitivities=False).contact_force == 0.0
    just = draft.solve([50.0, 0.0], touch - 1e-5, sensitivities=False).contact_force
    assert 0.0 < just < 0.01


def test_a_small_pull_bends_the_finger_as_beam_theory_says(table):
    """w = F e L^2 / 2EI to first order in F, on quadratic cells; the rubber is 49 mm long, the tip is seen at 49.5 mm.

    The rest is what beams leave out: the clamp and the plate hold the section's width.
    """
    table["mesh"] = {"cells": [20, 5], "order": 2}
    del table["obstacle"]
    model = FingerModel(Scene.model_validate(table))
    F, e, L, EI = 0.1, 0.004, 0.049, model.problem.law.young_modulus * 0.010**4 / 12
    w = F * e / EI * (L**2 / 2 + L * 0.0005)
    assert model.solve([F, 0.0], sensitivities=False).tip[1] == pytest.approx(w, rel=0.02)


def test_a_load_that_is_not_reached_raises_with_the_last_good_load(draft):
    continuation = Continuation(draft.problem, StepOptions(halvings=1))
    continuation.rest()
    continuation.newton.options = NewtonOptions(iterations=2)
    with pytest.raises(LoadNotReached, match="no equilibrium beyond") as caught:
        continuation.advance([100.0, 0.0], None)
    assert np.all(caught.value.tensions < 100.0)
    assert np.isfinite(draft.problem.displacement).all()
    assert np.array_equal(continuation.tensions, caught.value.tensions)
    assert "lower tensions" not in str(caught.value)  # E A is 988 N


def test_a_load_is_given_up_when_failed_steps_took_too_many_iterations(draft):
    continuation = Continuation(draft.problem, StepOptions(wasted=20))
    continuation.rest()
    with pytest.raises(LoadNotReached, match=r"; failed steps took \d+ iterations") as caught:
        continuation.advance([1000.0, 0.0], None)
    newton = continuation.newton.options
    assert re.search(
        r"beyond tensions \[\d+.*\] N \(\d\d% of Young's modulus times area: take lower", str(caught.value)
    )
    taken = int(caught.value.reason.split()[-2])
    assert 20 < taken <= 20 + 2 * newton.iterations + newton.searches
    assert taken < continuation.iterations and caught.value.tensions[0] > 200.0


def test_a_failed_newton_attempt_leaves_the_model_as_it_was(draft):
    draft.continuation.rest()
    before = draft.problem.displacement.copy()
    draft.problem.set_loads([1e9, 0.0], None)
    with pytest.raises(NotConverged):
        Newton(draft.problem).solve()
    assert np.array_equal(draft.problem.displacement, before)


def test_a_singular_tangent_is_refused_when_it_is_factorised(draft, monkeypatch):
    draft.continuation.rest()
    newton = draft.continuation.newton
    newton.linearise()
    monkeypatch.setattr(draft.problem, "tangent", lambda: draft.problem.matrix.zeroEntries())
    with pytest.raises(NotConverged, match="factorisation failed"):
        newton.linearise()
    monkeypatch.undo()
    assert newton.linearise().negative_pivots == 0


def test_a_displacement_near_an_equilibrium_settles_there_and_another_is_given_up_after_one_attempt(draft):
    state = draft.solve([50.0, 20.0], sensitivities=False)
    continuation, most = draft.continuation, draft.continuation.newton.options.iterations
    continuation.start([50.0, 20.0], None, 1.001 * state.displacement)
    continuation.settle()
    assert np.abs(draft.problem.displacement - state.displacement).max() < 1e-8
    assert 0 < continuation.iterations <= most and not continuation.wasted
    continuation.start([50.0, 20.0], None, 10 * state.displacement)
    with pytest.raises(NotConverged) as failure:
        continuation.settle()
    assert failure.value.iterations == continuation.wasted <= 2 * most
    assert np.array_equal(draft.problem.displacement, 10 * state.displacement)


def test_a_nan_never_leaves_as_a_result(draft):
    draft.continuation.rest()
    draft.problem.set_loads([np.nan, 0.0], None)
    with pytest.raises(NotConverged, match="not finite"):
        Newton(draft.problem).solve()


def test_without_an_obstacle_no_contact_is_compiled_and_no_distance_taken(table):
    del table["obstacle"]
    model = FingerModel(Scene.model_validate(table))
    assert model.problem.forms.contact == []
    state = model.solve([50.0, 0.0], sensitivities=False)
    assert state.contact_force is None and "contact_force" not in state.as_json()
    with pytest.raises(ValueError, match="d must be left out"):
        model.solve([50.0, 0.0], 0.005)


def test_the_whole_range_of_tensions_is_reached_in_few_iterations(draft):
    for tensions in ([100.0, 0.0], [0.0, 100.0], [100.0, 100.0]):
        state = draft.solve(tensions, sensitivities=False)
        assert state.smallest_volume_ratio > 0
        assert state.newton_iterations <= 30 * (1 + (min(tensions) > 0) * 1.5)


def test_a_contact_line_takes_at_most_five_factorisations_a_state(draft):
    continuation, forces = draft.continuation, []
    before = continuation.newton.factorisations
    continuation.rest()
    continuation.advance([50.0, 20.0], None)
    reach, nearest = draft.problem.reach(), draft.scene.parameters[-1]["lower"]
    for share in 1 - np.cos(np.pi / 2 * np.arange(1, 6) / 9):  # dense where contact begins
        continuation.advance([50.0, 20.0], reach - share * (reach - nearest))
        forces.append(draft.problem.contact.force())
    assert np.all(np.diff([0.0, *forces]) > 0)
    assert continuation.newton.factorisations - before <= 25


def test_rest_to_the_strongest_pull_takes_at_most_22_factorisations(draft):
    before = draft.continuation.newton.factorisations
    draft.continuation.rest()
    draft.continuation.advance([100.0, 0.0], None)
    assert draft.continuation.newton.factorisations - before <= 22


def test_the_rest_of_a_path_may_be_shorter_than_the_shortest_step_of_a_bisection(draft):
    path = Continuation(draft.problem)
    bend = path.options.first_turn * (1 + 1e-5) / path._turns.actuators[0]
    path.advance([bend, 0.0], None)
    assert path.tensions == pytest.approx([bend, 0.0], abs=0)
    assert path.steps == 2
