"""Viscoelastic branches relax exactly, and are nothing to an equilibrium."""

import numpy as np
import pytest
from pydantic import ValidationError

from fingerfem import FingerModel
from fingerfem.dynamics.moving_problem import MovingProblem
from fingerfem.scene.scene import Scene

PRONY = [[0.5, 0.01], [0.25, 0.2]]


def scene(table: dict, **changes) -> Scene:
    table.pop("obstacle", None)
    table |= {"density": {"rubber": 1100.0}, "mesh": {"cells": [9, 5]}}
    table["material"] = {"law": "neo-hookean", "E": 1e6, "nu": 0.3, "prony": PRONY} | changes
    return Scene.model_validate(table)


@pytest.mark.parametrize("formulation", ["displacement", "mixed"])
def test_an_equilibrium_is_that_of_the_law_alone(table, formulation):
    tips = [
        FingerModel(scene(table, **one)).solve([2.0, 1.0], sensitivities=False).tip for one in ({}, {"prony": None})
    ]
    assert tips[0] == pytest.approx(tips[1], rel=1e-8) and abs(tips[0][1]) > 1e-3


def test_held_after_a_jump_branches_relax_by_their_exponentials_in_any_steps(table):
    problem = MovingProblem(scene(table))
    branches = problem.branches
    branches.begin(1e-12)
    problem.displacement[:] = 1e-4 * np.sin(1e3 * problem.rest).ravel()
    branches.settle(1e-12)
    S, (shares, times) = branches.elastic_stress(), np.array(PRONY).T
    begun = branches.stresses.copy()
    for k in range(2):
        assert begun[k] == pytest.approx(shares[k] * S, rel=1e-9, abs=1e-6)
    for steps in (1, 7):
        branches.stresses = begun
        for _ in range(steps):
            branches.begin(0.05 / steps)
            branches.settle(0.05 / steps)
        for k in range(2):
            expected = np.exp(-0.05 / times[k]) * begun[k]
            assert branches.stresses[k] == pytest.approx(expected, rel=1e-9, abs=1e-6)
    assert np.abs(S).max() > 1e3


def test_a_stress_that_grows_linearly_has_the_closed_form(table):
    """Q = g tau s (1 - exp(-t / tau)) of S = s t, in one step."""
    problem = MovingProblem(scene(table))
    problem.branches.begin(0.1)
    problem.displacement[:] = 1e-4 * np.sin(1e3 * problem.rest).ravel()
    problem.branches.settle(0.1)
    S = problem.branches.elastic_stress()
    for Q, (share, time) in zip(problem.branches.stresses, PRONY, strict=True):
        assert pytest.approx(share * time * S / 0.1 * (1 - np.exp(-0.1 / time)), rel=1e-9, abs=1e-6) == Q


@pytest.mark.parametrize("formulation", ["displacement", "mixed"])
def test_the_tangent_of_a_step_is_the_residual_s_derivative(table, formulation):
    problem = MovingProblem(scene(table, formulation=formulation))
    rng = np.random.default_rng(0)
    problem.branches.begin(0.02)
    problem.displacement[:] = 1e-4 * np.sin(1e3 * problem.rest).ravel()
    problem.branches.settle(0.02)
    problem.branches.begin(0.05)
    u, w = problem.displacement.copy(), rng.normal(size=problem.displacement.size)
    w[problem.held] = 0.0
    problem.extrapolate_stress()
    tangent = problem.tangent()
    direction, expected = tangent.createVecRight(), tangent.createVecLeft()
    direction.array[:] = w
    tangent.mult(direction, expected)
    ends = []
    for sign in (1, -1):
        problem.displacement[:] = u + sign * 1e-9 * w
        ends.append(problem.residual()[0].array_r.copy())
    free = np.setdiff1d(np.arange(w.size), problem.held)
    difference = ((ends[0] - ends[1]) / 2e-9 - expected.array_r)[free]
    assert np.abs(difference).max() < 1e-6 * np.abs(expected.array_r).max()


@pytest.mark.parametrize(
    ("changes", "rule"),
    [
        ({"law": "saint-venant-kirchhoff"}, "prony must be left out of a law without a volumetric part"),
        ({"prony": [[0.5]]}, "at least 2 items"),
        ({"prony": [[0.5, 0.0]]}, "greater than or equal to 0.000000001"),
        ({"prony": []}, "at least 1 item"),
    ],
)
def test_branches_that_a_law_cannot_have_are_refused(table, changes, rule):
    with pytest.raises(ValidationError, match=rule):
        scene(table, **changes)


def test_every_material_relaxes_by_its_own_branches(table):
    other = {"law": "yeoh", "E": 5e5, "nu": 0.3, "prony": [[0.8, 0.05]]}
    layer = {"name": "layer", "region": "section", "x": [0.01, 0.03], "material": other}
    problem = MovingProblem(scene(table | {"materials": [layer]}))
    branches, fields = problem.branches, problem.fields.overstress
    branches.begin(1e-12)
    assert [float(one.value) for one in fields.shares] == pytest.approx([0.75, 0.8], rel=1e-9)
    problem.displacement[:] = 1e-4 * np.sin(1e3 * problem.rest).ravel()
    branches.settle(1e-12)
    S, x = branches.elastic_stress(), problem.mesh.midpoints[0]
    within, rubber = (x > 0.01) & (x < 0.03), (x < 0.01) | ((x > 0.03) & (x < 0.049))
    assert branches.stresses[0][within] == pytest.approx(0.8 * S[within], rel=1e-9, abs=1e-6)
    assert not branches.stresses[1][within].any()
    assert branches.stresses[1][rubber] == pytest.approx(0.25 * S[rubber], rel=1e-9, abs=1e-6)
    assert not branches.stresses[:, x > 0.049].any()
