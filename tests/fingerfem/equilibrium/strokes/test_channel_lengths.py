"""Lengths of channels up to every section: closed forms of stretches, turns and bends, and differences."""

import tomllib

import numpy as np
import pytest
from farm import ROOT
from mpi4py import MPI
from scipy.spatial.transform import Rotation

from fingerfem.discretisation.problem import Problem
from fingerfem.equilibrium.state import channel_shortening
from fingerfem.equilibrium.strokes.channel_lengths import ChannelLengths
from fingerfem.scene.scene import Scene

LENGTH, PLATE = 0.05, 0.001
OFFSETS = np.array([[0.004, 0.0], [0.0, 0.004]])


@pytest.fixture(scope="module")
def problem() -> Problem:
    table = tomllib.loads((ROOT / "scenes" / "draft.toml").read_text())
    del table["obstacle"]
    table |= {"mesh": {"cells": [10, 5], "order": 1}, "load": {"force": 3.0}, "sampling": {"lines": 16}}
    return Problem(Scene.model_validate(table), MPI.COMM_SELF)


@pytest.fixture(scope="module")
def lengths(problem) -> ChannelLengths:
    return ChannelLengths(problem)


@pytest.fixture
def rest(problem):
    yield problem.space.tabulate_dof_coordinates()
    problem.displacement[:] = 0.0


def ways(problem) -> np.ndarray:
    """Length of a channel up to every section of the mesh [m]; it ends before its plate."""
    sections = np.unique(np.round(problem.space.tabulate_dof_coordinates()[:, 0], 12))
    return np.minimum(sections, LENGTH - PLATE)


def shortening(problem, lengths, displacement) -> np.ndarray:
    problem.displacement[:] = displacement.ravel()
    return lengths.quantities(np.zeros((1, problem.displacement.size)))["section_shortening"]


def test_a_homogeneous_deformation_lengthens_a_channel_by_the_stretch_along_it(problem, lengths, rest):
    """Its length is |F e_x| times the way: a shear counts by Pythagoras."""
    gradient = np.array([[0.1, 0.3, 0.2], [0.2, -0.1, 0.1], [-0.1, 0.2, 0.3]])
    stretch = np.linalg.norm(np.array([1.0, 0, 0]) + gradient[:, 0])
    found = shortening(problem, lengths, rest @ gradient.T)
    assert found == pytest.approx(np.outer((1 - stretch) * ways(problem), [1, 1]), abs=1e-12)


def test_a_rigid_motion_shortens_nothing_and_the_problem_stays_where_it_was(problem, lengths, rest):
    turn = Rotation.from_rotvec([0.4, -1.1, 0.7])
    moved = turn.apply(rest) - rest + [0.01, 0.02, -0.01]
    assert shortening(problem, lengths, moved) == pytest.approx(np.zeros((len(ways(problem)), 2)), abs=1e-12)
    ChannelLengths(problem)
    assert np.array_equal(problem.displacement, moved.ravel())


def test_a_small_bend_shortens_a_tendon_by_its_offset_times_the_turn(problem, lengths, rest):
    """Under a curvature c the shortening up to x is c y x, with the offset y to the inner side."""
    curvature = 0.02
    x, y = rest[:, 0], rest[:, 1]
    bent = np.column_stack([-curvature * x * y, curvature * x**2 / 2, 0 * x])
    expected = curvature * np.outer(ways(problem), OFFSETS[:, 0])
    assert shortening(problem, lengths, bent) == pytest.approx(expected, abs=2e-3 * expected.max())


def test_up_to_the_tip_plate_it_is_the_shortening_of_the_whole_tendon(problem, lengths, rest):
    wavy = 1e-3 * np.sin(rest @ np.array([[90.0, 30, 10], [50, 80, 20], [70, 10, 60]])) * rest[:, :1] / LENGTH
    found = shortening(problem, lengths, wavy)
    assert len(found) == len(ways(problem)) and not found[0].any()
    assert found[-1] == pytest.approx(channel_shortening(problem), rel=1e-9) and np.abs(found[-1]).min() > 1e-6


def test_changes_are_differences(problem, lengths, rest):
    random = np.random.default_rng(2)
    at, changes, h = 1e-4 * random.standard_normal(rest.shape), random.standard_normal((2, rest.size)), 1e-7
    problem.displacement[:] = at.ravel()
    jacobian = lengths.quantities(changes)["section_shortening_jacobian"]
    for k, way in enumerate(changes):
        after, before = (shortening(problem, lengths, at.ravel() + sign * h * way) for sign in (1, -1))
        assert jacobian[..., k] == pytest.approx((after - before) / (2 * h), abs=1e-5 * np.abs(jacobian).max())
    assert jacobian.shape == (len(ways(problem)), 2, 2) and np.abs(jacobian[1:]).min() > 0
