"""Contact with obstacles: closed forms of a rigid motion into a plane, and differences before balls."""

import tomllib

import numpy as np
import pytest
from farm import ROOT
from mpi4py import MPI

from fingerfem.discretisation.problem import Problem
from fingerfem.scene.scene import Scene

LENGTH, SIDE, CELL, DEEP = 0.05, 0.010, 0.002, 3e-6  # [m]
BALL = {"shape": "sphere", "centre": [LENGTH + 0.003, 0.0013, 0.0007], "radius": 0.003, "direction": [1.0, 0.2, 0.1]}


def before(**obstacle) -> Problem:
    """A coarse finger at rest before an obstacle."""
    table = tomllib.loads((ROOT / "scenes" / "draft.toml").read_text())
    del table["sampling"], table["obstacle"]["pad"]
    table |= {"mesh": {"cells": [10, 5], "order": 1}}
    table["obstacle"] |= obstacle
    return Problem(Scene.model_validate(table), MPI.COMM_SELF)


@pytest.fixture(scope="module")
def plane() -> Problem:
    return before()


@pytest.fixture(scope="module")
def ball() -> Problem:
    return before(**BALL)


def placed(problem: Problem, distance: float) -> Problem:
    problem.set_loads([0.0, 0.0], distance)
    return problem


def test_a_plane_in_the_undeformed_face_presses_by_its_stiffness_its_depth_and_the_area(plane):
    """A penalty k gives N = k depth A, energy = k depth^2 A / 2, and twice that as the pressure's work.

    Points of the rule are nodes: those on the face's edges count with half a cell of the faces beside it, too.
    """
    contact, k = placed(plane, -DEEP).contact, plane._contact_stiffness()
    area = LENGTH * SIDE + (2 * LENGTH + SIDE) * CELL / 2
    assert contact.force() == pytest.approx(k * DEEP * area, rel=1e-9)
    assert contact.energy() == pytest.approx(k * DEEP**2 * area / 2, rel=1e-9)
    assert contact.gap_work() == pytest.approx(k * DEEP**2 * area, rel=1e-9)
    assert contact.stiffness() == pytest.approx(k * area, rel=1e-9)
    pressed = contact.nodal_force().sum(axis=0)
    assert pressed == pytest.approx([0.0, contact.force(), 0.0], abs=1e-9 * contact.force())
    assert plane.penetration() == pytest.approx(DEEP) and not len(contact.springs().gaps)


def test_an_obstacle_that_is_away_does_nothing(plane, ball):
    for problem in (plane, ball):
        contact = placed(problem, 0.02).contact
        assert contact.force() == contact.energy() == contact.gap_work() == contact.stiffness() == 0.0
        assert not contact.nodal_force().any() and not contact.spring_forces().any() and contact.penetration() == 0.0


def test_forces_before_a_ball_are_differences_of_the_energy(ball):
    h, energies, forces = 1e-8, [], []
    for d in (-DEEP - h, -DEEP + h):
        contact = placed(ball, d).contact
        energies.append(contact.energy())
        forces.append(contact.force())
    contact = placed(ball, -DEEP).contact
    assert contact.force() == pytest.approx(-(energies[1] - energies[0]) / (2 * h), rel=1e-3)
    assert contact.stiffness() == pytest.approx(-(forces[1] - forces[0]) / (2 * h), rel=2e-2)
    direction = np.array(BALL["direction"]) / np.linalg.norm(BALL["direction"])
    assert contact.nodal_force().sum(axis=0) @ direction == pytest.approx(contact.force(), rel=1e-9)
    assert contact.penetration() > 0 and contact.gap_work() == pytest.approx(2 * contact.energy(), rel=1e-9)


def test_the_force_s_gradient_is_its_difference_along_any_motion(plane, ball):
    for problem, rel in ((plane, 1e-6), (ball, 2e-2)):
        contact = placed(problem, -DEEP).contact
        gradient = contact.force_gradient()
        values, h, ends = gradient.array_r.copy(), 1e-9, []
        gradient.destroy()
        along = np.zeros(len(values))
        along[1::3], along[::3] = 1.0, 0.7  # all nodes towards plane and ball
        along[problem.held] = 0.0
        for sign in (1, -1):
            problem.displacement[:] = sign * h * along
            ends.append(contact.force())
        problem.displacement[:] = 0.0
        assert values @ along == pytest.approx((ends[0] - ends[1]) / (2 * h), rel=rel) and values @ along > 0
        assert not values[problem.held].any()


def test_what_is_held_pulls_until_it_is_let_go(ball):
    contact = placed(ball, -DEEP).contact
    contact.hold(True)
    assert not contact.lets_go() and contact.force() > 0
    placed(ball, 1e-5)  # away from the ball
    assert contact.force() < 0
    assert contact.lets_go() and contact.force() == 0.0
    contact.hold(True)  # nothing presses that could be held
    placed(ball, 2e-5)
    assert contact.force() == 0.0 and not contact.lets_go()
    contact.hold(False)
