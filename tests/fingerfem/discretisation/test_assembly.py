"""Vectors and numbers of forms: what is held is zero, half a finger counts twice, gradients are differences."""

import tomllib

import numpy as np
import pytest
from farm import ROOT
from mpi4py import MPI

from fingerfem.discretisation.assembly import Assembly
from fingerfem.discretisation.problem import Problem
from fingerfem.scene.scene import Scene

TENSIONS = [30.0, 12.0]


def problem(in_plane: bool = False, comm: MPI.Comm = MPI.COMM_SELF) -> Problem:
    """A coarse finger, bent smoothly and pulled; in its plane of symmetry as half of it."""
    table = tomllib.loads((ROOT / "scenes" / "draft.toml").read_text())
    table |= {"mesh": {"cells": [10, 5], "order": 1}}
    table["tendons"][1]["offset"] = [-0.004, 0.0] if in_plane else [0.0, 0.004]
    found = Problem(Scene.model_validate(table), comm)
    x, y, z = found.space.tabulate_dof_coordinates().T / 0.02
    found.displacement[:] = 2e-4 * np.column_stack([x * y, x**2, 0.0 * z if in_plane else x * z]).ravel()
    found.set_loads(TENSIONS, 0.02)
    return found


@pytest.fixture(scope="module")
def whole() -> Problem:
    return problem()


def owned(vector) -> np.ndarray:
    values = vector.array_r.copy()
    vector.destroy()
    return values


def test_a_gradient_is_the_vector_but_for_what_is_held(whole):
    form = whole.forms.actuator_force
    whole.actuators.probe(TENSIONS)
    vector, gradient = owned(whole.vector(form)), owned(whole.gradient(form))
    free = np.setdiff1d(np.arange(len(vector)), whole.held)
    assert np.array_equal(vector[free], gradient[free]) and gradient[free].any()
    assert vector[whole.held].any() and not gradient[whole.held].any()


def test_a_gradient_is_the_difference_of_its_energy(whole):
    whole.actuators.probe(TENSIONS)
    gradient = owned(whole.gradient(whole.forms.actuator_force))
    along = np.random.default_rng(0).standard_normal(len(gradient))
    along[whole.held] = 0.0
    at, h, energies = whole.displacement.copy(), 1e-7, []
    for sign in (1, -1):
        whole.displacement[:] = at + sign * h * along
        energies.append(whole.scalar(whole.forms.actuator_energy))
    whole.displacement[:] = at
    assert (energies[0] - energies[1]) / (2 * h) == pytest.approx(gradient @ along, rel=1e-5)


def test_what_there_is_besides_is_added_at_its_nodes(whole):
    form, nodes = whole.forms.actuator_force, len(whole.displacement) // 3
    besides = np.random.default_rng(1).standard_normal((nodes, 3))
    alone, both = owned(whole.vector(form)), owned(whole.vector(form, besides))
    assert both - alone == pytest.approx(besides.ravel(), abs=1e-12)
    assert whole.nodal(form, besides).ravel() == pytest.approx(both, abs=1e-12)


def test_half_a_finger_counts_as_the_whole_one():
    """The deformation and the grid are the same: every second cell is the image of another."""
    half = problem(in_plane=True)
    assert half.scene.is_half and half.copies == 2 and half.summed(1.5) == 3.0
    other = Assembly(half.space, 1, half.held)
    for form in (half.forms.strain_energy, *half.forms.tip[:2]):
        assert half.scalar(form) == pytest.approx(2 * other.scalar(form)) and half.scalar(form) != 0
    assert half.scalar(half.forms.strain_energy) > 0


@pytest.mark.mpi
def test_ranks_sum_what_they_have_at_the_nodes_that_they_share():
    shared = problem(comm=MPI.COMM_WORLD)
    form, nodes = shared.forms.actuator_force, len(shared.displacement) // 3
    alone, both = shared.nodal(form).copy(), shared.nodal(form, np.ones((nodes, 3)))
    sharing = (both - alone)[: shared.space.dofmap.index_map.size_local]
    everywhere = shared.comm.allreduce(nodes)
    assert shared.comm.allreduce(float(sharing[:, 0].sum())) == pytest.approx(everywhere)
    assert sharing == pytest.approx(np.round(sharing), abs=1e-9) and sharing.min() > 0.5
    assert shared.summed(1.0) == shared.comm.size
